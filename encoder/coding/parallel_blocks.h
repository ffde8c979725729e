// Work on a mesh's splits in blocks of consecutive ones, by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace meshfront {

inline constexpr uint32_t kSplitsPerBlock = 8192;

[[nodiscard]] inline uint32_t blockCount(uint32_t splits) {
  return (splits + kSplitsPerBlock - 1) / kSplitsPerBlock;
}

// Calls work(block, first split, behind the last) once for every block, in any order and from
// `threads` threads at once, the calling one among them, which also calls progress(splits begun).
template <typename Work, typename Progress>
void forEachBlock(uint32_t splits, unsigned threads, const Work& work, const Progress& progress) {
  std::atomic<uint32_t> next = 0;
  const uint32_t blocks = blockCount(splits);
  const auto run = [&](bool reporting) {
    for (uint32_t block = next++; block < blocks; block = next++) {
      const uint32_t begin = block * kSplitsPerBlock;
      work(block, begin, std::min(splits, begin + kSplitsPerBlock));
      if (reporting) progress(begin);
    }
  };
  std::vector<std::thread> others;
  for (unsigned i = 1; i < std::min(threads, blocks); ++i) others.emplace_back(run, false);
  run(true);
  for (auto& thread : others) thread.join();
}

}  // namespace meshfront
