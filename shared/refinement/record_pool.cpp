#include "shared/refinement/record_pool.h"

#include <algorithm>

namespace meshfront {

RecordPool::Place RecordPool::keep(std::span<const uint8_t> source, uint64_t bitOffset,
                                   uint32_t bitLength) {
  const uint32_t wanted = blocksOf(bitLength);
  Place place = kNoPlace;
  for (uint32_t blocks = wanted; blocks < free_.size() && place == kNoPlace; ++blocks) {
    if (free_[blocks] == kNoPlace) continue;
    place = free_[blocks];
    free_[blocks] = static_cast<Place>(blocks_[place]);
    if (blocks > wanted) addFree(place + wanted, blocks - wanted);
  }
  if (place == kNoPlace) {
    place = static_cast<Place>(blocks_.size());
    blocks_.resize(blocks_.size() + wanted);
  }
  copyBits(source, bitOffset, bitLength,
           {reinterpret_cast<uint8_t*>(blocks_.data() + place), size_t{wanted} * sizeof(uint64_t)});
  return place;
}

void RecordPool::drop(Place place, uint32_t bitLength) {
  addFree(place, blocksOf(bitLength));
}

void RecordPool::addFree(Place place, uint32_t blocks) {
  if (blocks >= free_.size()) free_.resize(size_t{blocks} + 1, kNoPlace);
  blocks_[place] = free_[blocks];
  free_[blocks] = place;
}

void RecordPool::copyBits(std::span<const uint8_t> source, uint64_t bitOffset, uint32_t bitLength,
                          std::span<uint8_t> out) {
  BitReader in(source, bitOffset, bitOffset + bitLength);
  for (size_t at = 0; at < out.size(); at += sizeof(uint64_t)) {
    const uint64_t high = in.peek(32) << 32;  // zeros beyond the end
    in.skip(std::min<uint64_t>(32, in.left()));
    const uint64_t word = __builtin_bswap64(high | in.peek(32));
    in.skip(std::min<uint64_t>(32, in.left()));
    std::memcpy(out.data() + at, &word, sizeof(word));
  }
}

}  // namespace meshfront
