// A receiver with a disk cache: what it once had it never asks for again, service or not.
#include "shared/receiver/automatic_resume.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class CachedReceiverTest : public ReceiverTest, public ::testing::WithParamInterface<FetchMode> {
 protected:
  ReceiverOptions cached() {
    ReceiverOptions options;
    options.mode = GetParam();
    options.batch = 60;
    options.freshRanking = false;
    options.cacheFolder = folder_.path();
    options.clock = [this] { return time_; };
    return options;
  }
  // As an owner's loop does, as long as anything moves. Half of the mesh is seen.
  void work(Receiver& receiver, bool answering = true) {
    for (int i = 0; i < 20'000; ++i) {
      bool moved = false;
      if (answering && !transport_.held.empty()) {
        answered_.push_back(transport_.held[0].request.url);
        transport_.answer(service_);
        moved = true;
      }
      if (receiver.waitForArrival(milliseconds(0))) {
        receiver.advance();
        moved = true;
      }
      if (receiver.mesh() != nullptr && receiver.wantsRanking()) {
        receiver.rank(halfSeen(receiver));
        moved = true;
      }
      if (!moved) return;
    }
    ADD_FAILURE() << "goes on without end";
  }
  static std::vector<uint32_t> halfSeen(const Receiver& receiver) {
    const SelectivelyRefinedMesh& mesh = *receiver.mesh();
    std::vector<uint32_t> pixels(mesh.vertexSlotCount(), 0);
    for (VertexSlot slot = 0; slot < pixels.size(); ++slot)
      pixels[slot] = mesh.positions()[slot][0] > 8'000 ? 3 : 0;
    return pixels;
  }
  void loseTheService() {
    FetchResponse lost;
    lost.error = {ErrorCode::unavailable, "no answer from host: Connection refused"};
    while (!transport_.held.empty()) transport_.complete(0, lost);
  }
  uint64_t firstRun() {
    Receiver& receiver = start(cached());
    work(receiver);
    EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
    const uint64_t records = receiver.mesh()->splitsApplied();
    EXPECT_GT(records, 300U);
    receiver_.reset();
    answered_.clear();
    return records;
  }

  // What comes from the disk comes in another order, and a few nodes more or less are seen.
  static void expectAboutAsMany(const Receiver& receiver, uint64_t records) {
    EXPECT_GE(receiver.mesh()->splitsApplied(), records * 9 / 10);
    EXPECT_LE(receiver.mesh()->splitsApplied(), records * 11 / 10);
  }

  TemporaryFolder folder_;
  std::vector<std::string> answered_;
  std::chrono::steady_clock::time_point time_{std::chrono::hours(1)};
};

TEST_P(CachedReceiverTest, ContinuesWhereItStopped) {
  const uint64_t records = firstRun();
  Receiver& receiver = start(cached());
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
  expectAboutAsMany(receiver, records);
  EXPECT_EQ(answered_, std::vector<std::string>{url().metadata()});  // and nothing else
  EXPECT_EQ(receiver.statistics().requests, 0U);
  EXPECT_EQ(receiver.statistics().recordsFromDisk, receiver.mesh()->splitsApplied());
  EXPECT_EQ(receiver.statistics().answerBytesDown, 0U);
}

TEST_P(CachedReceiverTest, RepeatsItselfWithFreshRankingsToo) {
  ReceiverOptions options = cached();
  options.freshRanking = true;
  Receiver& first = start(options);
  work(first);
  const uint64_t records = first.mesh()->splitsApplied();
  receiver_.reset();
  answered_.clear();
  Receiver& second = start(options);
  work(second);
  EXPECT_EQ(second.state(), ReceiverState::settled) << second.reason();
  EXPECT_LE(second.mesh()->splitsApplied(), records * 11 / 10);
  EXPECT_EQ(answered_.size(), 1U);
}

TEST_P(CachedReceiverTest, AsksOnlyForWhatItNeverHad) {
  firstRun();
  ReceiverOptions options = cached();
  options.goal = Goal::complete;
  Receiver& receiver = start(options);
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_GT(receiver.statistics().recordsFromDisk, 300U);
  EXPECT_EQ(receiver.statistics().records, service_.splitCount());
  expectWholeMesh(receiver);
  // Everything is on the disk now.
  receiver_.reset();
  answered_.clear();
  Receiver& third = start(options);
  work(third);
  EXPECT_EQ(third.state(), ReceiverState::complete) << third.reason();
  EXPECT_EQ(answered_.size(), 1U);
}

TEST_P(CachedReceiverTest, WorksOfflineAndGoesOnOnline) {
  const uint64_t records = firstRun();
  Receiver& receiver = start(cached());
  loseTheService();
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("Connection refused; offline, showing what the disk cache"),
            std::string::npos)
      << receiver.reason();
  ASSERT_NE(receiver.mesh(), nullptr);
  work(receiver, false);
  expectAboutAsMany(receiver, records);
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_TRUE(transport_.held.empty());
  // Back: what the view still lacks is asked for.
  AutomaticResume resume(AutomaticResume::kPolicy, 1);
  EXPECT_FALSE(resume.tend(receiver, time_));
  ASSERT_TRUE(resume.nextResumeAfter(time_));
  EXPECT_LE(*resume.nextResumeAfter(time_), seconds(1));
  time_ += seconds(1);
  EXPECT_TRUE(resume.tend(receiver, time_));
  EXPECT_FALSE(resume.nextResumeAfter(time_));
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
  receiver.rank(everywhere(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
}

TEST_P(CachedReceiverTest, ShowsTheCachedCopyWhileTheServiceTakesItsTime) {
  const uint64_t records = firstRun();
  Receiver& receiver = start(cached());
  receiver.advance();
  EXPECT_EQ(receiver.mesh(), nullptr);
  time_ += milliseconds(600);
  receiver.advance();
  ASSERT_NE(receiver.mesh(), nullptr);
  work(receiver, false);
  expectAboutAsMany(receiver, records);
  EXPECT_EQ(transport_.held.size(), 1U);  // still the metadata alone
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
  EXPECT_EQ(answered_.size(), 1U);
}

TEST_P(CachedReceiverTest, UsesANewRevisionFromTheStart) {
  firstRun();
  service_.revision = service_.knownRevision = std::string(32, 'b');
  Receiver& receiver = start(cached());
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
  EXPECT_EQ(receiver.metadata()->revision, service_.revision);
  EXPECT_EQ(receiver.statistics().recordsFromDisk, 0U);
  EXPECT_GT(receiver.statistics().records, 300U);
  for (const std::string& asked : answered_)
    EXPECT_EQ(asked.find(std::string(32, 'a')), std::string::npos) << asked;
}

TEST_P(CachedReceiverTest, NoticesANewRevisionBehindWhatItShows) {
  firstRun();
  service_.revision = service_.knownRevision = std::string(32, 'b');
  Receiver& receiver = start(cached());
  time_ += seconds(1);
  receiver.advance();
  ASSERT_NE(receiver.mesh(), nullptr);
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("published anew"), std::string::npos) << receiver.reason();
  EXPECT_FALSE(receiver.canResume());
  receiver_.reset();
  Receiver& next = start(cached());
  loseTheService();  // what it learned stays
  next.advance();
  EXPECT_EQ(next.mesh(), nullptr);  // of the new revision there is no base
}

TEST_P(CachedReceiverTest, AsksForWhatIsDamagedOnTheDisk) {
  const uint64_t records = firstRun();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
    if (!entry.path().filename().string().starts_with("segment-")) continue;
    std::filesystem::resize_file(entry.path(), entry.file_size() * 2 / 3);
  }
  Receiver& receiver = start(cached());
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
  EXPECT_GE(receiver.mesh()->splitsApplied(), records * 9 / 10);
  EXPECT_EQ(receiver.statistics().malformed, 0U);
}

TEST_P(CachedReceiverTest, StaysWithinTheAllowanceFromTheDiskToo) {
  firstRun();
  Receiver& receiver = start(cached());
  receiver.setSplitAllowance(40);
  work(receiver);
  EXPECT_TRUE(receiver.budgetReached());
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 40U);
  receiver.setSplitAllowance(60);
  work(receiver);
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 100U);
  EXPECT_EQ(receiver.statistics().requests, 0U);
}

TEST_P(CachedReceiverTest, TwoAtOnceShareAFolder) {
  Receiver& first = start(cached());
  ScriptedTransport other;
  Receiver second(url(), cached(), other);
  for (int i = 0; i < 5'000; ++i) {
    if (!other.held.empty()) other.answer(service_);
    if (!transport_.held.empty()) transport_.answer(service_);
    for (Receiver* receiver : {&first, &second}) {
      receiver->advance();
      if (receiver->mesh() != nullptr && receiver->wantsRanking())
        receiver->rank(halfSeen(*receiver));
    }
  }
  EXPECT_EQ(first.state(), ReceiverState::settled) << first.reason();
  EXPECT_EQ(second.state(), ReceiverState::settled) << second.reason();
  EXPECT_EQ(first.cache()->problem() + second.cache()->problem(), "");
}

TEST_P(CachedReceiverTest, WorksWithoutACacheThatCannotBeUsed) {
  ReceiverOptions options = cached();
  options.cacheFolder = "/dev/null/cache";
  Receiver& receiver = start(options);
  work(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::settled) << receiver.reason();
  EXPECT_NE(receiver.cache()->problem().find("not written"), std::string::npos);
}

TEST(AutomaticResume, WaitsLongerEachTimeAndAnewAfterSuccess) {
  AutomaticResume resume(AutomaticResume::kPolicy, 7);
  ScriptedTransport transport;
  const MeshService service(TestMesh::torus(12, 8));
  Receiver receiver(*parseMeshUrl("http://host/v1/meshes/torus"), {}, transport);
  std::chrono::steady_clock::time_point now{};
  FetchResponse lost;
  lost.error = {ErrorCode::unavailable, "no answer"};
  EXPECT_FALSE(resume.tend(receiver, now));
  EXPECT_FALSE(resume.nextResumeAfter(now));
  for (const int least : {500, 1'000, 2'000, 4'000, 8'000, 15'000, 15'000}) {
    transport.complete(0, lost);
    receiver.advance();
    EXPECT_FALSE(resume.tend(receiver, now));
    const auto wait = *resume.nextResumeAfter(now);
    EXPECT_GE(wait, milliseconds(least));
    EXPECT_LE(wait, milliseconds(std::min(2 * least, 30'000)));
    now += wait;
    EXPECT_TRUE(resume.tend(receiver, now));
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, CachedReceiverTest,
                         ::testing::Values(FetchMode::exact, FetchMode::chunks),
                         [](const auto& info) { return fetchModeName(info.param); });

}  // namespace
}  // namespace meshfront
