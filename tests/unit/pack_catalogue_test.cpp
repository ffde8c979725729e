#include "service/pack_catalogue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "tests/data/synthetic_mesh.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

constexpr std::chrono::hours kLongGrace(1);

class PackCatalogueTest : public ::testing::Test {
 protected:
  // The revision that was written.
  std::string write(const std::string& file, const std::string& name, uint32_t seed) {
    const auto written =
        writePack(folder_ / file, makeSyntheticMesh({.name = name, .seed = seed}).content);
    EXPECT_TRUE(written);
    return written ? written->revision : std::string();
  }
  void writeBytes(const std::string& file, const std::string& bytes) {
    std::ofstream(folder_ / "new", std::ios::binary) << bytes;
    std::filesystem::rename(folder_ / "new", folder_ / file);
  }
  void read(std::chrono::milliseconds grace = kLongGrace, size_t maxRetired = 64) {
    auto catalogue =
        PackCatalogue::read(folder_.path(), std::make_shared<MemoryBudget>(size_t{1} << 24),
                            {.grace = grace, .maxRetired = maxRetired});
    ASSERT_TRUE(catalogue) << catalogue.error().message;
    catalogue_ = std::move(*catalogue);
  }
  static std::string textOf(const Result<Described>& described) {
    if (!described) return {};
    const auto bytes = described->json.bytes();
    return {bytes.begin(), bytes.end()};
  }
  std::string list() { return textOf(catalogue_->list(Waiting::refused)); }
  std::string describe(const std::string& mesh) {
    return textOf(catalogue_->describe(mesh, Waiting::refused));
  }
  std::string revisionOffered(const std::string& mesh) {
    const auto metadata = metadataFromJson(describe(mesh));
    return metadata ? metadata->revision : "none";
  }
  std::shared_ptr<RecordStore> open(const std::string& mesh, const std::string& revision) {
    auto store = catalogue_->open(mesh, revision, Waiting::refused);
    return store ? *store : nullptr;
  }

  TemporaryFolder folder_;
  std::unique_ptr<PackCatalogue> catalogue_;
};

TEST_F(PackCatalogueTest, TakesUpNewPacks) {
  write("a.pack", "first", 1);
  read();
  catalogue_->rescan();
  EXPECT_EQ(catalogue_->statistics().loads, 1U);  // nothing has changed
  const std::string before = list();
  const std::string revision = write("b.pack", "second", 2);
  catalogue_->rescan();
  EXPECT_EQ(catalogue_->size(), 2U);
  EXPECT_NE(list(), before);
  EXPECT_NE(list().find(revision), std::string::npos);
  EXPECT_NE(open("second", revision), nullptr);
  EXPECT_EQ(catalogue_->statistics().loads, 2U);
}

TEST_F(PackCatalogueTest, OffersANewRevisionAndKeepsTheOldOneAnswerable) {
  const std::string old = write("a.pack", "mesh", 1);
  read();
  const auto held = open("mesh", old);
  const std::string next = write("a.pack", "mesh", 2);
  ASSERT_NE(old, next);
  EXPECT_EQ(open("mesh", next), nullptr);  // not yet
  catalogue_->rescan();
  EXPECT_EQ(revisionOffered("mesh"), next);
  EXPECT_EQ(list().find(old), std::string::npos);
  ASSERT_NE(open("mesh", next), nullptr);
  EXPECT_EQ(open("mesh", old), held);
  EXPECT_EQ(catalogue_->statistics().retired, 1U);
  EXPECT_EQ(catalogue_->open("other", old, Waiting::refused).error().code, ErrorCode::notFound);
}

TEST_F(PackCatalogueTest, ForgetsOldRevisionsAfterTheGracePeriod) {
  const std::string old = write("a.pack", "mesh", 1);
  read(std::chrono::milliseconds(0));
  const auto held = open("mesh", old);
  const std::string next = write("a.pack", "mesh", 2);
  catalogue_->rescan();
  EXPECT_EQ(open("mesh", old), nullptr);
  EXPECT_NE(open("mesh", next), nullptr);
  // A request that has it goes on.
  const SyntheticMesh mesh = makeSyntheticMesh({.name = "mesh", .seed = 1});
  const std::vector<NodeId> wanted = mesh.nodesAtDepth(5);
  const auto answer = held->collect(wanted, {}, {}, Waiting::refused);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->bytes, mesh.answerTo(wanted, {}));
}

TEST_F(PackCatalogueTest, KeepsNoMoreOldRevisionsThanAllowed) {
  std::vector<std::string> revisions{write("a.pack", "mesh", 1)};
  read(kLongGrace, 2);
  for (uint32_t seed = 2; seed < 7; ++seed) {
    revisions.push_back(write("a.pack", "mesh", seed));
    catalogue_->rescan();
  }
  EXPECT_EQ(catalogue_->statistics().retired, 2U);
  for (size_t i = 0; i < revisions.size(); ++i)
    EXPECT_EQ(open("mesh", revisions[i]) != nullptr, i + 3 >= revisions.size()) << i;
}

TEST_F(PackCatalogueTest, ARevisionThatComesBackIsCurrent) {
  const std::string first = write("a.pack", "mesh", 1);
  read();
  write("a.pack", "mesh", 2);
  catalogue_->rescan();
  write("a.pack", "mesh", 1);
  catalogue_->rescan();
  EXPECT_EQ(revisionOffered("mesh"), first);
  EXPECT_EQ(catalogue_->statistics().retired, 1U);  // the second one
}

TEST_F(PackCatalogueTest, TheSameRevisionInANewFileRetiresNothing) {
  const std::string revision = write("a.pack", "mesh", 1);
  read();
  const std::string before = list();
  EXPECT_EQ(write("a.pack", "mesh", 1), revision);
  catalogue_->rescan();
  EXPECT_EQ(catalogue_->statistics().loads, 2U);
  EXPECT_EQ(catalogue_->statistics().retired, 0U);
  EXPECT_EQ(list(), before);
}

TEST_F(PackCatalogueTest, RemovedPacksLeaveTheCatalogue) {
  const std::string revision = write("a.pack", "mesh", 1);
  read();
  std::filesystem::remove(folder_ / "a.pack");
  catalogue_->rescan();
  EXPECT_EQ(catalogue_->size(), 0U);
  EXPECT_EQ(describe("mesh"), "");
  EXPECT_EQ(list().find("\"mesh\""), std::string::npos);
  EXPECT_NE(open("mesh", revision), nullptr);
}

TEST_F(PackCatalogueTest, BrokenPacksLeaveTheOldOneInService) {
  const std::string revision = write("a.pack", "mesh", 1);
  read();
  SyntheticMesh damaged = makeSyntheticMesh({.name = "mesh", .seed = 2});
  damaged.content.base[damaged.content.base.size() / 2] ^= 1;
  for (const bool whole : {false, true}) {  // a file of nonsense; a pack with a damaged base mesh
    if (whole) {
      ASSERT_TRUE(writePack(folder_ / "a.pack", damaged.content));
    } else {
      writeBytes("a.pack", std::string(10'000, 'x'));
    }
    const uint64_t failures = catalogue_->statistics().failures;
    catalogue_->rescan();
    catalogue_->rescan();
    EXPECT_EQ(catalogue_->statistics().failures, failures + 1);
    EXPECT_EQ(catalogue_->statistics().brokenFiles, 1U);
    EXPECT_EQ(catalogue_->statistics().retired, 0U);
    EXPECT_EQ(revisionOffered("mesh"), revision);
    EXPECT_NE(open("mesh", revision), nullptr);
  }
  const std::string mended = write("a.pack", "mesh", 3);
  catalogue_->rescan();
  EXPECT_EQ(catalogue_->statistics().brokenFiles, 0U);
  EXPECT_EQ(revisionOffered("mesh"), mended);
}

TEST_F(PackCatalogueTest, APackBeingWrittenIsTakenUpOnceItIsWhole) {
  write("whole", "mesh", 1);
  std::ifstream whole(folder_ / "whole", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(whole), {});
  read();
  for (const size_t part : {size_t{0}, size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    std::ofstream(folder_ / "a.pack", std::ios::binary) << bytes.substr(0, part);
    catalogue_->rescan();
    EXPECT_EQ(catalogue_->size(), 0U) << part;
    EXPECT_EQ(catalogue_->statistics().brokenFiles, 1U);
  }
  writeBytes("a.pack", bytes);
  catalogue_->rescan();
  EXPECT_EQ(catalogue_->size(), 1U);
  EXPECT_EQ(catalogue_->statistics().brokenFiles, 0U);
}

TEST_F(PackCatalogueTest, TheSecondPackOfANameTakesOverWhenTheFirstGoes) {
  const std::string first = write("a.pack", "mesh", 1);
  const std::string second = write("b.pack", "mesh", 2);
  read();
  EXPECT_EQ(catalogue_->size(), 1U);
  EXPECT_EQ(revisionOffered("mesh"), first);
  std::filesystem::remove(folder_ / "a.pack");
  catalogue_->rescan();
  EXPECT_EQ(revisionOffered("mesh"), second);
  EXPECT_NE(open("mesh", first), nullptr);
}

TEST_F(PackCatalogueTest, AFolderThatCannotBeReadChangesNothing) {
  TemporaryFolder outer;
  std::filesystem::create_directory(outer / "packs");
  ASSERT_TRUE(writePack(outer / "packs/a.pack", makeSyntheticMesh({.name = "mesh"}).content));
  auto catalogue =
      *PackCatalogue::read(outer / "packs", std::make_shared<MemoryBudget>(size_t{1} << 24));
  std::filesystem::rename(outer / "packs", outer / "elsewhere");
  catalogue->rescan();
  EXPECT_EQ(catalogue->statistics().lostScans, 1U);
  EXPECT_EQ(catalogue->size(), 1U);
  std::filesystem::rename(outer / "elsewhere", outer / "packs");
  catalogue->rescan();
  EXPECT_EQ(catalogue->statistics().lostScans, 1U);
  EXPECT_EQ(catalogue->size(), 1U);
}

TEST_F(PackCatalogueTest, HiddenAndOtherFilesAreNoPacks) {
  write(".a.pack", "hidden", 1);
  write("a.packed", "other", 1);
  read();
  EXPECT_EQ(catalogue_->size(), 0U);
  EXPECT_EQ(catalogue_->statistics().failures, 0U);
}

TEST_F(PackCatalogueTest, RequestsGoOnWhilePacksAreReplaced) {
  const SyntheticMesh meshes[2] = {makeSyntheticMesh({.name = "mesh", .seed = 1}),
                                   makeSyntheticMesh({.name = "mesh", .seed = 2})};
  std::string revisions[2];
  for (int i = 0; i < 2; ++i) revisions[i] = revisionOf(meshes[i].content);
  ASSERT_TRUE(writePack(folder_ / "a.pack", meshes[0].content));
  read(std::chrono::milliseconds(0));
  std::atomic<bool> ended{false};
  std::atomic<int> wrong{0};
  std::atomic<int> right{0};
  std::vector<std::thread> receivers;
  receivers.reserve(3);
  for (int i = 0; i < 3; ++i)
    receivers.emplace_back([&] {
      while (!ended) {
        const std::string revision = revisionOffered("mesh");
        const int which = revision == revisions[0] ? 0 : 1;
        if (revision != revisions[which]) ++wrong;
        const auto store = open("mesh", revision);
        if (!store) continue;  // replaced between the two calls
        const std::vector<NodeId> wanted = meshes[which].nodesAtDepth(6);
        const auto answer = store->collect(wanted, {}, {}, Waiting::refused);
        if (answer && answer->bytes == meshes[which].answerTo(wanted, {}))
          ++right;
        else
          ++wrong;
      }
    });
  for (int i = 1; i < 12; ++i) {
    ASSERT_TRUE(writePack(folder_ / "a.pack", meshes[i % 2].content));
    catalogue_->rescan();
    EXPECT_EQ(revisionOffered("mesh"), revisions[i % 2]);
    for (const int before = right; right == before && wrong == 0;) std::this_thread::yield();
  }
  ended = true;
  for (std::thread& receiver : receivers) receiver.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace meshfront
