// The disk cache by itself: what is kept comes back, and damage, a full disk and other processes
// cost records at most.
#include "shared/receiver/disk_cache.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <random>

#include "shared/receiver/record_segment.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

namespace fs = std::filesystem;

const std::string kRevisionA(32, 'a');
const std::string kRevisionB(32, 'b');

// Node n of a made-up mesh, and its record: some bits that depend on n.
NodeId cachedNode(uint32_t n) {
  NodeId id = NodeId::root(n % 97);
  for (uint32_t rest = n / 97; rest > 0; rest /= 2) id = id.child(rest % 2 != 0);
  return id;
}
std::vector<uint8_t> recordBytes(uint32_t n) {
  std::vector<uint8_t> bytes(9);
  for (size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<uint8_t>(n * 31 + i * 7 + (n >> 8));
  return bytes;
}
constexpr uint64_t kOffset = 3;
uint32_t recordLength(uint32_t n) {
  return 20 + n % 40;
}

class DiskCacheTest : public ::testing::Test {
 protected:
  std::unique_ptr<DiskCache> open(uint64_t budget = uint64_t{64} << 20,
                                  const std::string& revision = kRevisionA,
                                  const std::string& mesh = "torus") {
    auto cache = DiskCache::open(folder_.path() / "cache", budget,
                                 *parseMeshUrl("http://host/v1/meshes/" + mesh));
    cache->useRevision(revision);
    return cache;
  }
  static void keepRange(DiskCache& cache, uint32_t from, uint32_t to) {
    for (uint32_t n = from; n < to; ++n)
      cache.keep(cachedNode(n), recordBytes(n), kOffset, recordLength(n));
  }
  // How many of them are there; those must be right.
  static uint32_t countSound(DiskCache& cache, uint32_t from, uint32_t to) {
    uint32_t found = 0;
    for (uint32_t n = from; n < to; ++n) {
      const auto record = cache.find(cachedNode(n));
      if (!record) continue;
      ++found;
      EXPECT_EQ(record->bitLength, recordLength(n));
      BitReader have(record->bytes, record->bitOffset, record->bitOffset + record->bitLength);
      const std::vector<uint8_t> bytes = recordBytes(n);
      BitReader want(bytes, kOffset, kOffset + recordLength(n));
      for (uint32_t i = 0; i < recordLength(n); ++i) EXPECT_EQ(have.read(1), want.read(1));
    }
    return found;
  }
  [[nodiscard]] std::vector<fs::path> segments() const {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (entry.path().filename().string().starts_with("segment-")) paths.push_back(entry.path());
    return paths;
  }
  [[nodiscard]] uint64_t bytesUsed() const {
    uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (entry.is_regular_file()) bytes += entry.file_size();
    return bytes;
  }
  // Of three blocks, 20 records each.
  fs::path segmentOfBlocks() {
    const auto cache = open();
    for (uint32_t n = 0; n < 60; n += 20) {
      keepRange(*cache, n, n + 20);
      cache->flush();
    }
    return segments().at(0);
  }
  static std::vector<uint8_t> contentOf(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const fs::path& path, std::span<const uint8_t> bytes) {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  }
  TemporaryFolder folder_;
};

TEST_F(DiskCacheTest, GivesBackWhatItWasGiven) {
  {
    const auto cache = open();
    EXPECT_FALSE(cache->has(cachedNode(1)));
    keepRange(*cache, 0, 5'000);
    EXPECT_EQ(countSound(*cache, 0, 6'000), 5'000U);  // what waits to be written, too
    keepRange(*cache, 0, 5'000);
  }
  const auto cache = open();
  EXPECT_EQ(cache->statistics().records, 5'000U);
  EXPECT_EQ(countSound(*cache, 0, 6'000), 5'000U);
  EXPECT_EQ(cache->statistics().damagedBytes, 0U);
  EXPECT_EQ(cache->problem(), "");
  keepRange(*cache, 0, 5'000);
  cache->flush();
  EXPECT_EQ(cache->statistics().written, 0U);
  EXPECT_EQ(segments().size(), 1U);
  EXPECT_EQ(countSound(*open(uint64_t{64} << 20, kRevisionB), 0, 6'000), 0U);
  EXPECT_EQ(countSound(*open(uint64_t{64} << 20, kRevisionA, "other"), 0, 6'000), 0U);
}

TEST_F(DiskCacheTest, KeepsDocumentsAsAWhole) {
  const std::vector<uint8_t> base(5'000, 7);
  {
    const auto cache = open();
    EXPECT_FALSE(cache->metadata());
    EXPECT_FALSE(cache->base());
    cache->keepMetadata(std::vector<uint8_t>{'{', '}'}, kRevisionA);
    cache->keepBase(base);
    cache->keepChunkIndex(std::vector<uint8_t>{1, 2, 3});
  }
  const auto cache = open();
  EXPECT_EQ(cache->metadata(), (std::vector<uint8_t>{'{', '}'}));
  EXPECT_EQ(cache->base(), base);
  EXPECT_EQ(cache->chunkIndex(), (std::vector<uint8_t>{1, 2, 3}));
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
    if (entry.path().filename() != "base") continue;
    std::vector<uint8_t> bytes = contentOf(entry.path());
    bytes[1'234] ^= 1;
    write(entry.path(), bytes);
  }
  EXPECT_FALSE(cache->base());
}

TEST_F(DiskCacheTest, ReadsWhatIsSoundOfASegmentCutAnywhere) {
  const fs::path path = segmentOfBlocks();
  const std::vector<uint8_t> whole = contentOf(path);
  uint32_t before = 0;
  for (size_t length = 0; length <= whole.size(); ++length) {
    write(path, std::span(whole).first(length));
    const uint32_t found = countSound(*open(), 0, 60);
    EXPECT_GE(found, before) << length;
    EXPECT_EQ(found % 20, 0U) << length;
    before = found;
  }
  EXPECT_EQ(before, 60U);
}

TEST_F(DiskCacheTest, LeavesOutWhatIsDamagedAndNothingElse) {
  const fs::path path = segmentOfBlocks();
  const std::vector<uint8_t> whole = contentOf(path);
  for (size_t at = 0; at < whole.size(); ++at) {
    std::vector<uint8_t> damaged = whole;
    damaged[at] ^= static_cast<uint8_t>(1U << at % 8);
    write(path, damaged);
    const auto cache = open();
    EXPECT_EQ(countSound(*cache, 0, 60), at < kSegmentHeaderBytes ? 0U : 40U) << at;
    EXPECT_GT(cache->statistics().damagedBytes, 0U);
  }
}

TEST_F(DiskCacheTest, SurvivesDamageUnderItsFeet) {
  {
    const auto cache = open();
    keepRange(*cache, 0, 20'000);
  }
  const auto cache = open();
  const std::vector<uint8_t> zeros(200'000, 0);
  write(segments().at(0), zeros);  // shorter, and no block in it
  EXPECT_EQ(countSound(*cache, 0, 20'000), 0U);
  EXPECT_FALSE(cache->has(cachedNode(1)));
}

TEST_F(DiskCacheTest, ReadsAnyBytesAsASegment) {
  std::mt19937 random(5);
  const std::vector<uint8_t> header = segmentHeader(1);
  uint64_t entries = 0;
  for (int round = 0; round < 3'000; ++round) {
    std::vector<uint8_t> payload;
    for (uint32_t n = 0; n < random() % 30; ++n)
      appendEntry(payload, cachedNode(random() % 10'000), recordBytes(n), kOffset, recordLength(n));
    // Sound checksums over nonsense, too.
    for (uint32_t flips = random() % 4; flips > 0 && !payload.empty(); --flips)
      payload[random() % payload.size()] = static_cast<uint8_t>(random());
    std::vector<uint8_t> bytes = header;
    for (int block = 0; block < 3; ++block) {
      const std::vector<uint8_t> coded = encodeBlock(payload);
      bytes.insert(bytes.end(), coded.begin(), coded.end());
    }
    for (uint32_t flips = random() % 3; flips > 0; --flips)
      bytes[header.size() + random() % (bytes.size() - header.size())] =
          static_cast<uint8_t>(random());
    bytes.resize(bytes.size() - random() % 5);
    const SegmentScan scan = scanSegment(
        bytes, 1,
        [&](const SegmentEntry& entry, size_t block, size_t at, std::span<const uint8_t> inside) {
          ++entries;
          EXPECT_LE(entry.bitOffset + entry.bitLength, inside.size() * 8);
          EXPECT_LE(entry.end, inside.size());
          EXPECT_LT(at, entry.end);
          EXPECT_LT(block, bytes.size());
        });
    EXPECT_LE(scan.damagedBytes, bytes.size());
  }
  EXPECT_GT(entries, 10'000U);
  // Every octet pair begins a block whose checksum is wrong: takes no time all the same.
  std::vector<uint8_t> hostile = header;
  while (hostile.size() < (size_t{8} << 20))
    for (const int octet : {int{'M'}, int{'F'}, int{'R'}, int{'B'}, 0, 0xFF, 0, 0})
      hostile.push_back(static_cast<uint8_t>(octet));
  EXPECT_EQ(scanSegment(hostile, 1, [](auto&&...) {}).blocks, 0U);
}

TEST_F(DiskCacheTest, SharesItsFolder) {
  const auto first = open();
  const auto second = open();
  keepRange(*first, 0, 3'000);
  keepRange(*second, 2'000, 5'000);
  first->flush();
  second->flush();
  EXPECT_EQ(segments().size(), 2U);
  EXPECT_EQ(countSound(*first, 0, 5'000), 3'000U);
  EXPECT_EQ(countSound(*second, 0, 5'000), 3'000U);
  EXPECT_EQ(countSound(*open(), 0, 5'000), 5'000U);  // while both are open
}

TEST_F(DiskCacheTest, KeepsToItsBudgetAndDropsWhatWasUsedLongestAgo) {
  constexpr uint64_t kBudget = 200'000;
  const std::vector<std::string> meshes{"one", "two", "three", "four", "five", "six"};
  for (const std::string& mesh : meshes) {
    const auto cache = open(kBudget, kRevisionA, mesh);
    keepRange(*cache, 0, 6'000);
    cache->flush();
    EXPECT_EQ(cache->problem(), "") << mesh;
    EXPECT_EQ(countSound(*cache, 0, 6'000), 6'000U) << mesh;
    EXPECT_LE(bytesUsed(), kBudget);
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (entry.path().filename() == "in-use")
        fs::last_write_time(entry.path(), entry.last_write_time() - std::chrono::minutes(1));
  }
  EXPECT_EQ(countSound(*open(kBudget, kRevisionA, "six"), 0, 6'000), 6'000U);
  EXPECT_EQ(countSound(*open(kBudget, kRevisionA, "one"), 0, 6'000), 0U);
}

TEST_F(DiskCacheTest, NeverDropsWhatIsInUse) {
  constexpr uint64_t kBudget = 200'000;
  const auto first = open(kBudget, kRevisionA, "one");
  keepRange(*first, 0, 8'000);
  first->flush();
  const auto second = open(kBudget, kRevisionA, "two");
  keepRange(*second, 0, 20'000);
  second->flush();
  EXPECT_NE(second->problem().find("full of what is in use"), std::string::npos)
      << second->problem();
  EXPECT_LE(bytesUsed(), kBudget);
  EXPECT_EQ(countSound(*first, 0, 8'000), 8'000U);
  EXPECT_GT(countSound(*second, 0, 20'000), 0U);  // what was written stays of use
}

TEST_F(DiskCacheTest, DropsOldSegmentsOfItsOwnRevisionWhenItBegins) {
  constexpr uint64_t kBudget = 300'000;
  for (uint32_t run = 0; run < 20; ++run) {
    const auto cache = open(kBudget);
    keepRange(*cache, run * 3'000, (run + 1) * 3'000);
    cache->flush();
    EXPECT_LE(bytesUsed(), kBudget);
    EXPECT_GT(countSound(*cache, run * 3'000, (run + 1) * 3'000), 2'000U) << run;
  }
}

TEST_F(DiskCacheTest, AgesOutOldRevisions) {
  constexpr uint64_t kBudget = 160'000;
  {
    const auto other = open(kBudget, kRevisionA, "other");
    keepRange(*other, 0, 6'000);
  }
  {
    const auto cache = open(kBudget);
    keepRange(*cache, 0, 6'000);
  }
  const auto cache = open(kBudget, kRevisionB);
  cache->keepMetadata(std::vector<uint8_t>{'x'}, kRevisionB);
  keepRange(*cache, 0, 8'000);
  cache->flush();
  EXPECT_EQ(cache->problem(), "");
  EXPECT_EQ(countSound(*open(kBudget), 0, 6'000), 0U);  // younger than "other", but of no use
  EXPECT_EQ(countSound(*open(kBudget, kRevisionA, "other"), 0, 6'000), 6'000U);
}

TEST_F(DiskCacheTest, MergesTheSegmentsOfManyRuns) {
  for (uint32_t run = 0; run < 60; ++run) {
    const auto cache = open();
    keepRange(*cache, run * 50, run * 50 + 50);
  }
  EXPECT_LE(segments().size(), 30U);
  const auto cache = open();
  EXPECT_EQ(countSound(*cache, 0, 3'000), 3'000U);
}

TEST_F(DiskCacheTest, LivesOnAFullDisk) {
  const auto cache = open();
  keepRange(*cache, 0, 3'000);
  cache->flush();
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little{100'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &little);
  keepRange(*cache, 3'000, 30'000);
  cache->flush();
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(cache->problem().find("not written any more"), std::string::npos);
  EXPECT_NE(cache->problem().find("File too large"), std::string::npos) << cache->problem();
  const uint32_t sound = countSound(*cache, 0, 30'000);
  EXPECT_GE(sound, 3'000U);
  EXPECT_LT(sound, 30'000U);
  const auto again = open();
  EXPECT_EQ(countSound(*again, 0, 30'000), sound);
  EXPECT_EQ(again->statistics().damagedBytes, 0U);  // the torn tail was cut off
}

TEST_F(DiskCacheTest, IsEmptyWhereItMayNotWrite) {
  write(folder_.path() / "cache", std::vector<uint8_t>{1});  // a file in the folder's place
  const auto cache = open();
  EXPECT_NE(cache->problem(), "");
  keepRange(*cache, 0, 10);
  EXPECT_EQ(countSound(*cache, 0, 10), 0U);
  EXPECT_FALSE(cache->metadata());
  cache->keepBase(std::vector<uint8_t>{1});
}

}  // namespace
}  // namespace meshfront
