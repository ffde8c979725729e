#include "shared/http/record_service.h"

#include <gtest/gtest.h>

#include "service/pack_catalogue.h"
#include "shared/bits/base64url.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/split_request.h"
#include "shared/store/entity_tag.h"
#include "tests/data/synthetic_mesh.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

class RecordServiceTest : public ::testing::Test {
 protected:
  RecordServiceTest() {
    EXPECT_TRUE(writePack(folder_ / "a.pack", mesh_.content));
    auto catalogue =
        PackCatalogue::read(folder_.path(), std::make_shared<MemoryBudget>(size_t{1} << 24));
    EXPECT_TRUE(catalogue);
    catalogue_ = std::move(*catalogue);
    service_ = std::make_unique<RecordService>(*catalogue_, metrics_, RecordService::Options{});
    bitstring_ = *encodeTreeBitstring(wanted_);
  }

  HttpResponse ask(std::string_view method, const std::string& target, HttpRequest request = {}) {
    request.method = method;
    request.target = target;
    auto response = service_->answerAtOnce(request);
    EXPECT_TRUE(response);
    return response ? std::move(*response) : HttpResponse{};
  }
  static std::string field(const HttpResponse& response, std::string_view name) {
    for (const auto& [key, value] : response.headers)
      if (key == name) return value;
    return {};
  }
  static std::string text(const HttpResponse& response) {
    const auto bytes = response.content.bytes();
    return {bytes.begin(), bytes.end()};
  }
  static std::vector<uint8_t> bytes(const HttpResponse& response) {
    const auto content = response.content.bytes();
    return {content.begin(), content.end()};
  }
  void expectProblem(const HttpResponse& response, unsigned status) {
    EXPECT_EQ(response.status, status) << text(response);
    EXPECT_EQ(field(response, "Content-Type"), "application/problem+json");
    EXPECT_EQ(field(response, "Cache-Control"), status == 404 ? "public, max-age=10" : "no-store");
    EXPECT_EQ(field(response, "Access-Control-Allow-Origin"), "*");
    EXPECT_NE(text(response).find("\"status\":" + std::to_string(status)), std::string::npos);
    EXPECT_EQ(text(response).find(folder_.path().string()), std::string::npos);
  }
  [[nodiscard]] std::string fixed() const {
    return "/v1/meshes/synthetic/" + revisionOf(mesh_.content);
  }
  [[nodiscard]] std::string splits() const {
    return fixed() + "/splits/" + base64urlEncode(bitstring_);
  }

  TemporaryFolder folder_;
  SyntheticMesh mesh_ = makeSyntheticMesh();
  std::vector<NodeId> wanted_ = mesh_.nodesAtDepth(4);
  std::vector<uint8_t> bitstring_;
  Metrics metrics_;
  std::unique_ptr<PackCatalogue> catalogue_;
  std::unique_ptr<RecordService> service_;
};

constexpr const char* kImmutable = "public, max-age=31536000, immutable, no-transform";

TEST_F(RecordServiceTest, ListsAndDescribes) {
  const HttpResponse list = ask("GET", "/v1/meshes");
  EXPECT_EQ(list.status, 200U);
  EXPECT_EQ(field(list, "Content-Type"), "application/json");
  EXPECT_EQ(field(list, "Cache-Control"), "public, max-age=10");
  EXPECT_NE(text(list).find(revisionOf(mesh_.content)), std::string::npos);
  const HttpResponse one = ask("GET", "/v1/meshes/synthetic");
  const auto metadata = metadataFromJson(text(one));
  ASSERT_TRUE(metadata) << metadata.error().message;
  EXPECT_EQ(metadata->splitCount, mesh_.entries.size());
  EXPECT_NE(field(one, "ETag"), field(list, "ETag"));
}

TEST_F(RecordServiceTest, ServesConstantsAsImmutable) {
  for (const auto& [resource, content] :
       {std::pair(std::string("/base"), mesh_.content.base),
        std::pair(std::string("/chunks"), mesh_.content.chunkIndex),
        std::pair(std::string("/chunks/3"), mesh_.content.chunks[3])}) {
    const HttpResponse response = ask("GET", fixed() + resource);
    EXPECT_EQ(response.status, 200U);
    EXPECT_EQ(bytes(response), content) << resource;
    EXPECT_EQ(field(response, "Cache-Control"), kImmutable);
    EXPECT_EQ(field(response, "Content-Type"), "application/octet-stream");
    EXPECT_EQ(field(response, "ETag"),
              constantTag(revisionOf(mesh_.content),
                          resourceKey(revisionOf(mesh_.content), resource.substr(1))));
    EXPECT_EQ(field(response, "Vary"), "");
    EXPECT_EQ(field(response, "Age"), "");
    EXPECT_EQ(field(response, "Via"), "");
  }
}

TEST_F(RecordServiceTest, AnswersSetsByGetAndQueryAlike) {
  Expansion levels;
  levels.levels = 3;
  Expansion significance;
  significance.significance = 4;
  for (const Expansion& expansion : {Expansion{}, levels, significance}) {
    const HttpResponse got = ask("GET", splits() + expansionQuery(expansion));
    EXPECT_EQ(got.status, 200U) << text(got);
    EXPECT_EQ(bytes(got), mesh_.answerTo(wanted_, expansion));
    EXPECT_EQ(field(got, "Cache-Control"), kImmutable);
    HttpRequest query;
    query.contentType = "Application/Octet-Stream ; x=y";
    query.content = bitstring_;
    const HttpResponse queried =
        ask("QUERY", fixed() + "/splits" + expansionQuery(expansion), query);
    EXPECT_EQ(queried.status, 200U);
    EXPECT_EQ(bytes(queried), bytes(got));
    EXPECT_EQ(field(queried, "Content-Location"), splits() + expansionQuery(expansion));
    EXPECT_EQ(field(queried, "ETag"), field(got, "ETag"));
  }
}

TEST_F(RecordServiceTest, AnswersConditionalRequests) {
  for (const std::string& target : {splits(), fixed() + "/base", std::string("/v1/meshes")}) {
    const HttpResponse plain = ask("GET", target);
    HttpRequest request;
    const std::string tags = "\"x\", W/" + field(plain, "ETag");
    request.ifNoneMatch = tags;
    for (const char* method : {"GET", "HEAD"}) {
      const HttpResponse conditional = ask(method, target, request);
      EXPECT_EQ(conditional.status, 304U);
      EXPECT_EQ(field(conditional, "ETag"), field(plain, "ETag"));
      EXPECT_EQ(field(conditional, "Cache-Control"), field(plain, "Cache-Control"));
    }
    request.ifNoneMatch = "\"x\"";
    EXPECT_EQ(ask("GET", target, request).status, 200U);
    request.ifNoneMatch = "*";
    EXPECT_EQ(ask("GET", target, request).status, 304U);
  }
  HttpRequest request;
  request.ifNoneMatch = "*";
  EXPECT_EQ(ask("GET", "/v1/meshes/none", request).status, 404U);
}

TEST_F(RecordServiceTest, ObjectsInTheStatedOrder) {
  expectProblem(ask("GET", "/v1/meshes/" + std::string(kMaxTargetOctets, 'a')), 414);
  EXPECT_EQ(ask("GET", "/v1/meshes/" + std::string(kMaxTargetOctets - 11, 'a')).status, 404U);
  expectProblem(ask("GET", "/v2"), 404);
  expectProblem(ask("GET", "/v1/meshes/none"), 404);
  expectProblem(ask("GET", "/v1/meshes/none/" + revisionOf(mesh_.content) + "/base"), 404);
  expectProblem(ask("GET", "/v1/meshes/synthetic/" + std::string(32, '0') + "/base"), 404);
  expectProblem(ask("GET", "/v1/meshes?x=1"), 400);
  expectProblem(ask("GET", fixed() + "/base?"), 400);
  expectProblem(ask("GET", fixed() + "/chunks/01"), 400);
  expectProblem(ask("GET", fixed() + "/chunks/x"), 400);
  expectProblem(ask("GET", fixed() + "/chunks/99999"), 404);
  expectProblem(ask("GET", splits() + "?levels=0"), 400);
  expectProblem(ask("GET", splits() + "?significance=7"), 400);
  expectProblem(ask("GET", splits() + "A"), 400);
  const auto leaf = *encodeTreeBitstring(std::vector{NodeId::root(3)});
  expectProblem(ask("GET", fixed() + "/splits/" + base64urlEncode(leaf)), 404);
}

TEST_F(RecordServiceTest, ObjectsToMethods) {
  for (const char* method : {"POST", "PUT", "DELETE", "QUERY", "get"}) {
    const HttpResponse response = ask(method, fixed() + "/base");
    expectProblem(response, 405);
    EXPECT_EQ(field(response, "Allow"), "GET, HEAD, OPTIONS");
  }
  const HttpResponse response = ask("GET", fixed() + "/splits");
  expectProblem(response, 405);
  EXPECT_EQ(field(response, "Allow"), "QUERY, OPTIONS");
  const HttpResponse options = ask("OPTIONS", fixed() + "/splits");
  EXPECT_EQ(options.status, 204U);
  EXPECT_EQ(field(options, "Access-Control-Allow-Methods"), "QUERY, OPTIONS");
  EXPECT_EQ(field(options, "Accept-Query"), "application/octet-stream");
}

TEST_F(RecordServiceTest, ObjectsToContent) {
  HttpRequest query;
  query.content = bitstring_;
  for (const char* type : {"", "text/plain", "application/octet-streams"}) {
    query.contentType = type;
    expectProblem(ask("QUERY", fixed() + "/splits", query), 415);
  }
  query.contentType = "application/octet-stream";
  query.content = {};
  expectProblem(ask("QUERY", fixed() + "/splits", query), 400);
  query.contentTooLarge = true;
  expectProblem(ask("QUERY", fixed() + "/splits", query), 413);
}

TEST_F(RecordServiceTest, LeavesOutALocationThatIsTooLong) {
  const SyntheticMesh large = makeSyntheticMesh({.name = "large", .roots = 3000, .maxDepth = 4});
  ASSERT_TRUE(writePack(folder_ / "b.pack", large.content));
  const auto catalogue =
      PackCatalogue::read(folder_.path(), std::make_shared<MemoryBudget>(size_t{1} << 24));
  ASSERT_TRUE(catalogue);
  RecordService service(**catalogue, metrics_, {});
  const std::vector<NodeId> wanted = large.nodesAtDepth(3);
  const auto bitstring = *encodeTreeBitstring(wanted);
  ASSERT_GT(bitstring.size(), 6000U);
  HttpRequest query;
  query.method = "QUERY";
  const std::string target = "/v1/meshes/large/" + revisionOf(large.content) + "/splits";
  query.target = target;
  query.contentType = "application/octet-stream";
  query.content = bitstring;
  const HttpResponse response = service.answer(query);
  EXPECT_EQ(response.status, 200U);
  EXPECT_EQ(bytes(response), large.answerTo(wanted, {}));
  EXPECT_EQ(field(response, "Content-Location"), "");

  // A URL that may be asked for can be too long for a field of an answer.
  const std::vector<NodeId> some(wanted.begin(), wanted.begin() + wanted.size() / 4);
  const auto fewer = *encodeTreeBitstring(some);
  EXPECT_LT(splitTarget("large", revisionOf(large.content), fewer, {}).size(), kMaxTargetOctets);
  query.content = fewer;
  EXPECT_EQ(field(service.answer(query), "Content-Location"), "");
  const auto few = *encodeTreeBitstring(std::span(wanted).first(3));
  query.content = few;
  EXPECT_EQ(field(service.answer(query), "Content-Location"),
            splitTarget("large", revisionOf(large.content), few, {}));
}

TEST_F(RecordServiceTest, CountsWhatItDid) {
  static_cast<void>(ask("GET", splits()));
  static_cast<void>(ask("GET", splits() + "?levels=0"));
  const size_t chunk = bytes(ask("GET", fixed() + "/chunks/0")).size();
  static_cast<void>(ask("GET", fixed() + "/chunks/4000000000"));
  const std::string page = text(ask("GET", "/metrics"));
  for (const std::string& line :
       {std::string("meshfront_requests_total{route=\"splits\",status=\"200\"} 1\n"),
        std::string("meshfront_requests_total{route=\"splits\",status=\"400\"} 1\n"),
        "meshfront_requested_ids_total " + std::to_string(wanted_.size()) + "\n",
        "meshfront_records_total " + std::to_string(wanted_.size()) + "\n",
        "meshfront_record_bytes_total " + std::to_string(mesh_.answerTo(wanted_, {}).size()) + "\n",
        "meshfront_chunk_bytes_total " + std::to_string(chunk) + "\n"})
    EXPECT_NE(page.find(line), std::string::npos) << line << page;
  EXPECT_EQ(text(ask("GET", "/healthz")), "ok\n");
  EXPECT_EQ(ask("GET", "/readyz").status, 200U);
  EXPECT_EQ(field(ask("GET", "/healthz"), "Cache-Control"), "no-store");
}

TEST_F(RecordServiceTest, SkipsBrokenAndRepeatedPacks) {
  ASSERT_TRUE(writePack(folder_ / "z.pack", makeSyntheticMesh({.seed = 3}).content));
  std::filesystem::resize_file(folder_ / "z.pack", 5000);
  ASSERT_TRUE(writePack(folder_ / "y.pack", makeSyntheticMesh({.seed = 4}).content));
  const auto catalogue =
      PackCatalogue::read(folder_.path(), std::make_shared<MemoryBudget>(size_t{1} << 24));
  ASSERT_TRUE(catalogue);
  EXPECT_EQ((*catalogue)->size(), 1U);
  EXPECT_TRUE((*catalogue)->open("synthetic", revisionOf(mesh_.content), Waiting::refused));
}

}  // namespace
}  // namespace meshfront
