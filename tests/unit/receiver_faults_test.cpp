// What a receiver makes of damage, refusals and absent servers.
#include <set>

#include "shared/store/entity_tag.h"
#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

class ReceiverFaultsTest : public ReceiverTest {};

TEST_F(ReceiverFaultsTest, AsksOnceMoreAfterADamagedAnswer) {
  Receiver& receiver = connect(batches(10, 1));
  receiver.rank(everywhere(receiver));
  const std::vector<NodeId> wanted = requested(transport_.held[0]);
  FetchResponse damaged = service_.answer(transport_.held[0].request);
  damaged.body[damaged.body.size() / 2] ^= 0x10;
  transport_.complete(0, damaged);
  EXPECT_FALSE(receiver.advance());
  EXPECT_EQ(receiver.statistics().malformed, 1U);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_TRUE(transport_.held[0].request.bypassCaches);
  EXPECT_EQ(requested(transport_.held[0]), wanted);
  transport_.answer(service_);
  EXPECT_TRUE(receiver.advance());
  EXPECT_EQ(receiver.statistics().records, 10U);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
}

TEST_F(ReceiverFaultsTest, GivesUpAfterTwoDamagedAnswers) {
  Receiver& receiver = connect(batches(10, 2));
  receiver.rank(everywhere(receiver));
  for (int i = 0; i < 2; ++i) {
    FetchResponse cut = service_.answer(transport_.held[0].request);
    cut.body.pop_back();
    // The repetition goes behind the request that is still under way.
    transport_.complete(i == 0 ? 0 : transport_.held.size() - 1, cut);
    receiver.advance();
  }
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("damaged"), std::string::npos) << receiver.reason();
  EXPECT_TRUE(transport_.held.empty());  // cancelled
  EXPECT_NE(receiver.mesh(), nullptr);
  receiver.rank(everywhere(receiver));
  EXPECT_TRUE(transport_.held.empty());
  // It may heal, but is not tried for ever.
  for (unsigned i = 1; i < Receiver::kMostDamages; ++i) {
    ASSERT_TRUE(receiver.resume()) << i;
    for (int step = 0; step < 6 && receiver.state() != ReceiverState::degraded; ++step) {
      if (receiver.wantsRanking()) receiver.rank(everywhere(receiver));
      FetchResponse response = service_.answer(transport_.held.back().request);
      if (transport_.held.back().request.url != url().metadata()) response.body.pop_back();
      transport_.complete(transport_.held.size() - 1, response);
      receiver.advance();
    }
    ASSERT_EQ(receiver.state(), ReceiverState::degraded) << i;
  }
  EXPECT_FALSE(receiver.resume());
}

TEST_F(ReceiverFaultsTest, GoesOnAfterDamageThatHeals) {
  Receiver& receiver = start(batches(10, 2));
  FetchResponse page;
  page.status = 200;
  page.body = {'<', 'h', 't', 'm', 'l', '>'};
  const auto answerAll = [&](const std::optional<FetchResponse>& instead) {
    for (int i = 0; i < 20 && receiver.isAtWork() && !transport_.held.empty(); ++i) {
      FetchResponse response = service_.answer(transport_.held[0].request);
      transport_.complete(0, instead ? *instead : response);
      receiver.advance();
      if (instead) break;
    }
  };
  answerAll(page);  // the metadata
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  ASSERT_TRUE(receiver.resume());
  transport_.answer(service_);
  receiver.advance();
  answerAll(page);  // the base
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  ASSERT_TRUE(receiver.resume());
  transport_.answer(service_);
  receiver.advance();
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_TRUE(transport_.held[0].request.bypassCaches);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ReceiverFaultsTest, RefusesTheRecordsOfAnotherRequestByTheirTag) {
  Receiver& receiver = connect(batches(10, 1));
  receiver.rank(everywhere(receiver));
  FetchResponse mixedUp = service_.answer(transport_.held[0].request);
  mixedUp.headers["etag"] = recordsTag(mixedUp.body, 1);
  transport_.complete(0, mixedUp);
  receiver.advance();
  EXPECT_EQ(receiver.statistics().malformed, 1U);
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 0U);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ReceiverFaultsTest, RefusesAnswersWithMoreOrFewerRecords) {
  for (const bool more : {true, false}) {
    Receiver& receiver = connect(batches(10, 1));
    receiver.rank(everywhere(receiver));
    for (int i = 0; i < 2; ++i) {
      FetchRequest other = transport_.held[0].request;
      RecordRequest changed;
      changed.nodes = requested(transport_.held[0]);
      if (more) {
        changed.expansion.levels = 1;
      } else {
        changed.nodes.pop_back();
      }
      other = *toFetch(url(), service_.revision, changed);
      transport_.complete(0, service_.answer(other));
      receiver.advance();
    }
    EXPECT_EQ(receiver.state(), ReceiverState::degraded) << more;
    EXPECT_EQ(receiver.mesh()->splitsApplied(), 0U);
  }
}

TEST_F(ReceiverFaultsTest, NoticesANewRevision) {
  Receiver& receiver = connect(batches(10, 2));
  receiver.rank(everywhere(receiver));
  service_.revision = service_.knownRevision = std::string(32, 'b');
  transport_.answer(service_);  // 404
  receiver.advance();
  // No further records are asked for before the metadata has come, past caches.
  ASSERT_EQ(transport_.held.size(), 2U);
  EXPECT_EQ(transport_.held[1].request.url, url().metadata());
  EXPECT_TRUE(transport_.held[1].request.bypassCaches);
  transport_.answer(service_, 0);  // another 404
  receiver.advance();
  ASSERT_EQ(transport_.held.size(), 1U);
  transport_.answer(service_);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find(std::string(32, 'b')), std::string::npos) << receiver.reason();
  EXPECT_FALSE(receiver.resume());
}

TEST_F(ReceiverFaultsTest, EndsWhenTheNamedRevisionIsNotThere) {
  Receiver& receiver = connect(batches(10, 1));
  service_.knownRevision = std::string(32, 'c');
  for (int i = 0; i < 20 && receiver.isAtWork(); ++i) {
    if (receiver.wantsRanking()) receiver.rank(everywhere(receiver));
    ASSERT_FALSE(transport_.held.empty());
    transport_.answer(service_);
    receiver.advance();
  }
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("none of its records"), std::string::npos) << receiver.reason();
}

TEST_F(ReceiverFaultsTest, GoesOnWhenTheServerIsBack) {
  Receiver& receiver = connect(batches(10, 2));
  receiver.rank(everywhere(receiver));
  FetchResponse lost;
  lost.error = {ErrorCode::unavailable, "no answer from host: Connection refused"};
  lost.traffic = {6, 600, 0, 0};
  transport_.complete(0, lost);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_EQ(receiver.reason(), lost.error.message);
  EXPECT_TRUE(receiver.resume());
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ReceiverFaultsTest, SaysWhyItCannotConnect) {
  const auto reasonAfter = [this](FetchResponse response) {
    Receiver& receiver = start();
    transport_.complete(0, std::move(response));
    receiver.advance();
    EXPECT_EQ(receiver.state(), ReceiverState::degraded);
    EXPECT_EQ(receiver.mesh(), nullptr);
    transport_.held.clear();
    return receiver.reason();
  };
  FetchResponse response;
  response.status = 404;
  EXPECT_NE(reasonAfter(response).find("no mesh 'torus'"), std::string::npos);
  response.status = 200;
  const std::string html = "<html>hello</html>";
  response.body.assign(html.begin(), html.end());
  EXPECT_NE(reasonAfter(response).find("no mesh of the v1 interface"), std::string::npos);
  response.status = 403;
  const std::string problem = R"({"title":"Forbidden","detail":"not\nyou"})";
  response.body.assign(problem.begin(), problem.end());
  EXPECT_NE(reasonAfter(response).find("HTTP 403: Forbidden: not you"), std::string::npos);
}

TEST_F(ReceiverFaultsTest, SaysThatTheBaseIsOfAnotherVersion) {
  Receiver& receiver = start();
  transport_.answer(service_);
  receiver.advance();
  FetchResponse base = service_.answer(transport_.held[0].request);
  base.body[3] ^= 0xff;
  transport_.complete(0, base);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("base mesh is damaged or of another version"), std::string::npos)
      << receiver.reason();
}

}  // namespace
}  // namespace meshfront
