// Every seed of the fuzz targets through its target: none may crash or break a promise, and those
// named valid-... are accepted.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <vector>

#include "tests/fuzz/fuzz_targets.h"

namespace meshfront::fuzz {
namespace {

const std::filesystem::path kCorpus = MESHFRONT_FUZZ_CORPUS;

class FuzzCorpus : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, IsReplayed) {
  size_t valid = 0;
  size_t others = 0;
  for (const auto& file : std::filesystem::directory_iterator(kCorpus / GetParam().name)) {
    std::ifstream in(file.path(), std::ios::binary);
    const std::vector<char> content{std::istreambuf_iterator<char>(in), {}};
    EXPECT_LE(content.size(), 4096U) << file.path() << " is large for a seed";
    // A copy of the exact size, so that AddressSanitizer sees a read behind its end.
    const std::vector<uint8_t> bytes(content.begin(), content.end());
    const bool accepted = GetParam().run(bytes);
    const bool expected = file.path().filename().string().starts_with("valid-");
    if (expected) {
      EXPECT_TRUE(accepted) << file.path()
                            << ": if the format has changed, run build/bin/write-fuzz-seeds "
                               "tests/fuzz/corpus";
    }
    ++(expected ? valid : others);
  }
  EXPECT_GT(valid, 0U);
  EXPECT_GT(others, 0U);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, FuzzCorpus, ::testing::ValuesIn(kTargets),
                         [](const auto& info) {
                           std::string name(info.param.name);
                           std::erase(name, '-');
                           return name;
                         });

TEST(FuzzCorpusFolder, HasNoSeedsWithoutATarget) {
  std::set<std::string> folders;
  for (const auto& folder : std::filesystem::directory_iterator(kCorpus))
    folders.insert(folder.path().filename().string());
  std::set<std::string> names;
  for (const Target& target : kTargets) names.emplace(target.name);
  EXPECT_EQ(folders, names);
}

}  // namespace
}  // namespace meshfront::fuzz
