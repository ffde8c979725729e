// What comes along with the first request of all. The base mesh has few vertices, so what they show
// is soon asked for, and nearly all of what lies one or two generations below is needed by any
// picture: to ask for it in the same request spares a round trip and the fields of an answer for
// each generation. `?significance=L` names it (Expansion).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace meshfront {

// Records that the first answer may hold where the link is short (a long one takes more: see
// ExactSource). Found with tests/evaluation/quality: on most meshes twice or half as many need more
// octets to a good picture.
inline constexpr double kFirstRecords = 400;

// Up to level `most` below a node of `level`, the node's own included: from one octave to the next
// a mesh has twice the vertices. At least 1.
[[nodiscard]] double recordsUpTo(unsigned most, unsigned level);

// The finest level for which no more than `room` records are to be expected under nodes of these
// `levels`; nullopt where the nodes alone are that many. `pixels`: that they cover together, since
// what shows eight pixels cannot need more than eight leaves.
[[nodiscard]] std::optional<uint8_t> firstSignificance(std::span<const uint8_t> levels,
                                                       uint64_t pixels, double room,
                                                       unsigned maxLevel);

// Levels are octaves, so that what firstSignificance() finds may use but half of the room. How many
// of the nodes, from the first on, have room for the level after `most`: where a round trip counts,
// nearly all that is seen one level finer serves better than all of it, and the rest comes with the
// second request. 0 where there is no finer level.
[[nodiscard]] size_t nodesOneLevelFiner(std::span<const uint8_t> levels, uint8_t most, double room,
                                        unsigned maxLevel);

}  // namespace meshfront
