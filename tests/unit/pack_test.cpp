#include "shared/store/pack.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/data/synthetic_mesh.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

std::vector<uint8_t> copyOf(std::span<const uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

std::string readFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeFile(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

size_t filesIn(const std::filesystem::path& folder) {
  return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(Pack, ReturnsWhatWasWritten) {
  const TemporaryFolder folder;
  const SyntheticMesh mesh = makeSyntheticMesh();
  const auto written = writePack(folder / "a.pack", mesh.content);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->revision, revisionOf(mesh.content));
  EXPECT_EQ(written->chunkCount, mesh.content.chunks.size());
  EXPECT_EQ(written->baseBytes, mesh.content.base.size());

  const auto pack = Pack::open(folder / "a.pack");
  ASSERT_TRUE(pack) << pack.error().message;
  EXPECT_EQ((*pack)->metadata().name, "synthetic");
  EXPECT_EQ((*pack)->metadata().revision, written->revision);
  EXPECT_EQ(copyOf((*pack)->base()), mesh.content.base);
  EXPECT_EQ(copyOf((*pack)->chunkIndex()), mesh.content.chunkIndex);
  EXPECT_EQ((*pack)->reportJson(), mesh.content.reportJson);
  for (uint32_t i = 0; i < mesh.content.chunks.size(); ++i) {
    const auto chunk = (*pack)->chunk(i);
    ASSERT_TRUE(chunk) << i;
    EXPECT_EQ(copyOf(*chunk), mesh.content.chunks[i]) << i;
  }
  const auto beyond = (*pack)->chunk(written->chunkCount);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::notFound);
}

TEST(Pack, LeavesNothingBesideTheFile) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writePack(folder / "a.pack", makeSyntheticMesh().content));
  ASSERT_TRUE(Pack::open(folder / "a.pack"));
  EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(Pack, GivesUpWithoutATrace) {
  const SyntheticMesh mesh = makeSyntheticMesh();
  // Asked once after each entry and once before the file gets its name.
  const int questions = static_cast<int>(mesh.content.chunks.size()) + 5;
  for (int last = 0; last <= questions; ++last) {
    const TemporaryFolder folder;
    int asked = 0;
    const auto written =
        writePack(folder / "a.pack", mesh.content, [&] { return asked++ == last; });
    EXPECT_EQ(written.has_value(), last == questions);
    EXPECT_EQ(filesIn(folder.path()), last == questions ? 1U : 0U);
  }
}

TEST(Pack, KeepsTheOldFileOpenWhenReplaced) {
  const TemporaryFolder folder;
  const SyntheticMesh first = makeSyntheticMesh({.seed = 1});
  const SyntheticMesh second = makeSyntheticMesh({.seed = 2});
  ASSERT_TRUE(writePack(folder / "a.pack", first.content));
  const auto old = Pack::open(folder / "a.pack");
  ASSERT_TRUE(writePack(folder / "a.pack", second.content));
  const auto fresh = Pack::open(folder / "a.pack");
  ASSERT_TRUE(old);
  ASSERT_TRUE(fresh);
  EXPECT_EQ(copyOf((*old)->base()), first.content.base);
  EXPECT_EQ(copyOf((*fresh)->base()), second.content.base);
  EXPECT_NE((*old)->metadata().revision, (*fresh)->metadata().revision);
}

TEST(Pack, OpensInAFolderThatCannotBeWritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writePack(folder / "a.pack", makeSyntheticMesh().content));
  std::filesystem::permissions(folder / "a.pack", std::filesystem::perms::owner_read);
  std::filesystem::permissions(
      folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_TRUE(Pack::open(folder / "a.pack"));
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
}

TEST(Pack, FailsToWriteWhereThereIsNoFolder) {
  const TemporaryFolder folder;
  const auto written = writePack(folder / "none/a.pack", makeSyntheticMesh().content);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::unavailable);
}

TEST(Pack, RefusesNamesThatAreNoMeshNames) {
  const TemporaryFolder folder;
  PackContent content = makeSyntheticMesh().content;
  content.metadata.name = "../escape";
  EXPECT_FALSE(writePack(folder / "a.pack", content));
  EXPECT_EQ(filesIn(folder.path()), 0U);
}

TEST(Pack, RefusesEveryCutThatLosesAPage) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writePack(folder / "a.pack", makeSyntheticMesh().content));
  const std::string whole = readFile(folder / "a.pack");
  for (size_t length = 0; length < whole.size(); length += 1000) {
    writeFile(folder / "cut.pack", whole.substr(0, length));
    EXPECT_FALSE(Pack::open(folder / "cut.pack")) << length;
  }
}

TEST(Pack, RefusesOtherFiles) {
  const TemporaryFolder folder;
  writeFile(folder / "text.pack", std::string(100000, 'x'));
  EXPECT_FALSE(Pack::open(folder / "text.pack"));
  const auto missing = Pack::open(folder / "missing.pack");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::notFound);
  EXPECT_FALSE(Pack::open(folder.path()));
}

TEST(Revision, DependsOnEveryPartOfTheContent) {
  const PackContent content = makeSyntheticMesh().content;
  const std::string revision = revisionOf(content);
  EXPECT_TRUE(isRevision(revision));
  EXPECT_EQ(revisionOf(content), revision);
  const auto differs = [&](auto change) {
    PackContent changed = content;
    change(changed);
    return revisionOf(changed) != revision;
  };
  EXPECT_TRUE(differs([](PackContent& c) { c.base[9] ^= 1; }));
  EXPECT_TRUE(differs([](PackContent& c) { c.chunkIndex[9] ^= 1; }));
  EXPECT_TRUE(differs([](PackContent& c) { c.chunks.back().back() ^= 1; }));
  EXPECT_TRUE(differs([](PackContent& c) { std::swap(c.chunks[0], c.chunks[1]); }));
  EXPECT_TRUE(differs([](PackContent& c) { c.metadata.quantization.step *= 2; }));
  EXPECT_TRUE(differs([](PackContent& c) {  // the same bytes, cut elsewhere
    c.chunks[1].insert(c.chunks[1].begin(), c.chunks[0].back());
    c.chunks[0].pop_back();
  }));
  EXPECT_FALSE(differs([](PackContent& c) { c.reportJson += " "; }));
  EXPECT_FALSE(differs([](PackContent& c) { c.metadata.name = "other"; }));
}

}  // namespace
}  // namespace meshfront
