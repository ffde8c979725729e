// A record: everything about one vertex split that is not already known at its node.
//
// Layout, bits most significant first; every field parses without any other record, given only the
// node's own level (from its parent's record, the base mesh, or the chunk's band):
//   header   Huffman(by level): leaf flag of u, leaf flag of t, class of the cut region's length
//   levels   Huffman(by level): level of the child that is no leaf - own level, or of both jointly
//   classes  Huffman(by level): classes (value_class.h) of d_b and d_c, jointly; then Huffman(by
//   the
//            larger of them and the level): class of the residual of d_a
//   values   for b, c, a, unless zero: sign bit (1 = negative), then the bits the class leaves open
//   further  colour and normal, where the mesh has them (attribute_coding.h)
//   cut      the cut region (ring_cut.h), its length given by the header's class
// a is the axis of the largest component of the node's predicted normal, b and c the following axes
// cyclically (position_prediction.h); parsing needs neither.
#pragma once

#include <cstdint>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/codec/attribute_coding.h"
#include "shared/codec/code_tables.h"
#include "shared/codec/value_class.h"

namespace meshfront {

struct Record {
  bool leftIsLeaf = false;
  bool rightIsLeaf = false;
  uint8_t leftLevel = 0;  // significance levels, >= the node's own; of no meaning for a leaf
  uint8_t rightLevel = 0;
  int32_t deltaB = 0;  // grid steps
  int32_t deltaC = 0;
  int32_t residualA = 0;
  AttributeDelta attributes;
  uint32_t cutBegin = 0;  // bits from the record's first bit
  uint32_t cutEnd = 0;    // == the record's length in bits
};

// Untrusted. Reads one record of a node at significance level `level`; advances `in` behind it.
// On damage the reader is left overrun() and the record's content is arbitrary but in range.
Record readRecord(BitReader& in, const CodeTables& tables, unsigned level);

// Writes everything in front of the cut region; the tables must have a code for every symbol used.
void writeRecordHead(BitWriter& out, const Record& record, unsigned cutClass,
                     const CodeTables& tables, unsigned level);

// Symbols of a record's fields. Leaf flags: u * 2 + t. Levels: of the only child that is no leaf,
// or of both.
[[nodiscard]] unsigned leafFlagsOf(const Record& record);
[[nodiscard]] uint32_t levelSymbol(const Record& record, unsigned level);
[[nodiscard]] uint32_t levelPairSymbol(const Record& record, unsigned level);
}  // namespace meshfront
