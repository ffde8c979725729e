#include "shared/codec/answer.h"

#include <algorithm>

#include "shared/bits/crc32c.h"
#include "shared/codec/subtree_reader.h"

namespace meshfront {

Result<std::vector<RecordEntry>> parseAnswer(
    std::span<const uint8_t> bytes, std::span<const NodeId> wanted, const Expansion& expansion,
    const CodeTables& tables, const std::function<std::optional<unsigned>(const NodeId&)>& levelOf,
    size_t maxEntries) {
  const auto content = checkedContent(bytes, "answer");
  if (!content) return tl::unexpected(content.error());
  BitReader in(*content);
  std::vector<RecordEntry> entries;
  entries.reserve(std::min(wanted.size(), maxEntries));
  // A record is free of charge only in degenerate tables; this bounds the entries by the bytes.
  uint64_t limit = in.left() + wanted.size() + 1;
  const bool isLimited = maxEntries < limit;
  if (isLimited) limit = uint64_t{maxEntries} + 1;
  const auto descend = [&](unsigned generation, unsigned level) {
    return expansion.significance ? level <= *expansion.significance
                                  : generation <= expansion.levels;
  };
  std::vector<PendingRecord> pending;
  for (const NodeId& node : wanted) {
    if (isLimited && entries.size() >= limit) break;
    const auto level = levelOf(node);
    if (!level) return fail("answer: the level of a requested node is not known");
    if (entries.size() >= limit ||
        !readSubtree(in, tables, node, *level, descend, limit, pending, entries))
      return fail("answer: fewer records than asked for, or damaged ones");
  }
  if (isLimited && entries.size() >= limit)
    return fail(ErrorCode::tooLarge, "answer: more records than are allowed");
  if (entries.size() >= limit) return fail("answer: more records than its bytes can hold");
  if (in.left() >= 8 || in.read(static_cast<unsigned>(in.left())) != 0)
    return fail("answer: bits behind the last record");
  return entries;
}

}  // namespace meshfront
