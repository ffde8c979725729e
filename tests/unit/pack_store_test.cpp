#include "shared/store/pack_store.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/data/synthetic_mesh.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

constexpr size_t kPlenty = size_t{64} << 20;

class PackStoreTest : public ::testing::Test {
 protected:
  void open(const PackContent& content, size_t indexBytes = kPlenty) {
    ASSERT_TRUE(writePack(folder_ / "a.pack", content));
    auto pack = Pack::open(folder_ / "a.pack");
    ASSERT_TRUE(pack) << pack.error().message;
    budget_ = std::make_shared<MemoryBudget>(indexBytes);
    store_ = std::make_unique<PackStore>(*pack, budget_);
  }
  Result<Answer> collect(std::span<const NodeId> wanted, const Expansion& expansion = {}) {
    return store_->collect(wanted, expansion, limits_, Waiting::refused);
  }
  void expectRight(std::span<const NodeId> wanted, const Expansion& expansion = {}) {
    const auto answer = collect(wanted, expansion);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->bytes, mesh_.answerTo(wanted, expansion));
  }
  void expectError(std::span<const NodeId> wanted, ErrorCode code) {
    const auto answer = collect(wanted);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, code) << answer.error().message;
  }

  TemporaryFolder folder_;
  SyntheticMesh mesh_ = makeSyntheticMesh();
  CollectLimits limits_;
  std::shared_ptr<MemoryBudget> budget_;
  std::unique_ptr<PackStore> store_;
};

TEST_F(PackStoreTest, AnswersNodesOfEveryDepthFromCold) {
  for (unsigned depth = 0; depth < 12; ++depth) {
    open(mesh_.content);
    expectRight(mesh_.nodesAtDepth(depth));
  }
}

TEST_F(PackStoreTest, AnswersExpansions) {
  open(mesh_.content);
  for (unsigned depth = 0; depth < 8; depth += 2) {
    const std::vector<NodeId> wanted = mesh_.nodesAtDepth(depth);
    for (unsigned k = 1; k <= 13; k += 3) {
      Expansion expansion;
      expansion.levels = k;
      expectRight(wanted, expansion);
    }
    for (uint8_t level = 0; level <= 6; ++level) {
      Expansion expansion;
      expansion.significance = level;
      expectRight(wanted, expansion);
    }
  }
}

TEST_F(PackStoreTest, AnswersUnderAnyBudget) {
  for (const size_t bytes : {size_t{0}, size_t{2000}, size_t{20000}, size_t{100000}}) {
    open(mesh_.content, bytes);
    Expansion expansion;
    expansion.levels = 20;
    expectRight(mesh_.nodesAtDepth(0), expansion);
    expectRight(mesh_.nodesAtDepth(9));
    expectRight(mesh_.nodesAtDepth(2));
    EXPECT_LE(budget_->bytes(), bytes);
  }
}

TEST_F(PackStoreTest, RefusesNodesWithoutRecords) {
  open(mesh_.content);
  expectError(std::vector{NodeId::root(3)}, ErrorCode::notFound);   // a leaf
  expectError(std::vector{NodeId::root(12)}, ErrorCode::notFound);  // beyond the roots
  for (const RecordEntry& entry : mesh_.entries) {
    if (entry.leftIsLeaf) expectError(std::vector{entry.id.child(false)}, ErrorCode::notFound);
    if (entry.rightIsLeaf)
      expectError(std::vector{entry.id.child(true).child(true)}, ErrorCode::notFound);
  }
  expectRight(mesh_.nodesAtDepth(4));
}

TEST_F(PackStoreTest, KeepsTheLimits) {
  open(mesh_.content);
  limits_.maxRecords = 10;
  Expansion expansion;
  expansion.levels = 20;
  const auto answer = collect(mesh_.nodesAtDepth(0), expansion);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::tooLarge);
  limits_ = {};
  limits_.maxBytes = 100;
  expectError(mesh_.nodesAtDepth(8), ErrorCode::tooLarge);
}

TEST_F(PackStoreTest, ReportsDamage) {
  PackContent content = mesh_.content;
  for (auto& chunk : content.chunks) chunk[chunk.size() / 2] ^= 0x10;
  open(content);
  expectError(mesh_.nodesAtDepth(0), ErrorCode::invalid);
  content = mesh_.content;
  content.base.pop_back();
  open(content);
  expectError(mesh_.nodesAtDepth(0), ErrorCode::invalid);
  content = mesh_.content;
  content.chunkIndex[content.chunkIndex.size() / 2] ^= 1;
  open(content);
  expectError(mesh_.nodesAtDepth(0), ErrorCode::invalid);
  content = mesh_.content;
  content.chunks.pop_back();
  open(content);
  expectError(mesh_.nodesAtDepth(0), ErrorCode::invalid);
  content = mesh_.content;
  std::swap(content.chunks.front(), content.chunks.back());
  open(content);
  expectError(mesh_.nodesAtDepth(0), ErrorCode::invalid);
}

TEST_F(PackStoreTest, ServesNoDamagedResourceWhole) {
  PackContent content = mesh_.content;
  content.chunks.front()[content.chunks.front().size() / 2] ^= 1;
  open(content);
  EXPECT_TRUE(store_->base(Waiting::refused));
  EXPECT_TRUE(store_->chunkIndex(Waiting::refused));
  EXPECT_TRUE(store_->chunk(1, Waiting::refused));
  for (int twice = 0; twice < 2; ++twice) {
    const auto damaged = store_->chunk(0, Waiting::refused);
    ASSERT_FALSE(damaged);
    EXPECT_EQ(damaged.error().code, ErrorCode::invalid);
  }
  for (const auto resource : {&PackContent::base, &PackContent::chunkIndex}) {
    content = mesh_.content;
    (content.*resource)[(content.*resource).size() / 2] ^= 1;
    open(content);
    EXPECT_FALSE(store_->base(Waiting::refused));
    EXPECT_FALSE(store_->chunkIndex(Waiting::refused));
  }
}

TEST_F(PackStoreTest, AnswersManyThreadsAlike) {
  open(mesh_.content, 50000);  // too little for all: chunks come and go
  std::vector<std::vector<uint8_t>> expected;
  for (unsigned depth = 0; depth < 12; ++depth)
    expected.push_back(mesh_.answerTo(mesh_.nodesAtDepth(depth), {}));
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (unsigned i = 0; i < 48; ++i) {
        const unsigned depth = (i * 5 + t * 3) % 12;
        const auto answer = collect(mesh_.nodesAtDepth(depth));
        if (!answer || answer->bytes != expected[depth]) ++wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST_F(PackStoreTest, TwoStoresShareABudget) {
  open(mesh_.content, 100000);
  const SyntheticMesh other = makeSyntheticMesh({.name = "other", .seed = 9});
  ASSERT_TRUE(writePack(folder_ / "b.pack", other.content));
  const auto pack = Pack::open(folder_ / "b.pack");
  ASSERT_TRUE(pack);
  PackStore second(*pack, budget_);
  for (unsigned depth = 0; depth < 10; ++depth) {
    expectRight(mesh_.nodesAtDepth(depth));
    const auto wanted = other.nodesAtDepth(depth);
    const auto answer = second.collect(wanted, {}, {}, Waiting::refused);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->bytes, other.answerTo(wanted, {}));
    EXPECT_LE(budget_->bytes(), 100000U);
  }
}

}  // namespace
}  // namespace meshfront
