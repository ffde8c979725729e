#include "shared/codec/attribute_coding.h"

#include <algorithm>

#include "shared/codec/value_class.h"

namespace meshfront {
namespace {

constexpr unsigned kNormalBitsBits = 4;

unsigned colourContext(unsigned greenClass) {
  return std::min(greenClass / 2, kColourContexts - 1);
}

// Calls visit(code) for all codes of the layout, in the order of the wire.
template <typename Tables, typename Visit>
void forEachCode(Tables& tables, const Visit& visit) {
  if (tables.layout.colours) {
    for (auto& code : tables.green) visit(code, kColourClasses);
    for (auto& code : tables.red) visit(code, kColourRestClasses);
    for (auto& code : tables.blue) visit(code, kColourRestClasses);
    visit(tables.alpha, kColourClasses);
  }
  const unsigned classes = 2 * tables.layout.normalBits;
  if (classes != 0)
    for (auto& code : tables.normal) visit(code, classes * classes);
}

}  // namespace

AttributeDelta attributeDelta(const VertexAttributes& s, const VertexAttributes& t) {
  AttributeDelta out;
  std::array<int, 4> d{};
  for (size_t i = 0; i < 4; ++i) d[i] = int{t.colour[i]} - int{s.colour[i]};
  const std::array<int, 4> order{d[1], d[0] - d[1], d[2] - d[1], d[3]};
  for (size_t i = 0; i < 4; ++i) out.colour[i] = static_cast<int16_t>(order[i]);
  for (size_t i = 0; i < 2; ++i)
    out.normal[i] = static_cast<int16_t>(int{t.normal[i]} - int{s.normal[i]});
  return out;
}

bool addAttributes(const VertexAttributes& s, const AttributeDelta& delta,
                   const AttributeLayout& layout, VertexAttributes& out) {
  bool sound = true;
  if (layout.colours) {
    const auto& c = delta.colour;
    const std::array<int, 4> d{c[1] + c[0], c[0], c[2] + c[0], c[3]};
    for (size_t i = 0; i < 4; ++i) {
      const int value = s.colour[i] + d[i];
      sound = sound && value >= 0 && value <= 255;
      out.colour[i] = static_cast<uint8_t>(std::clamp(value, 0, 255));
    }
  }
  const int limit = (1 << layout.normalBits) - 1;
  if (layout.normalBits != 0)
    for (size_t i = 0; i < 2; ++i) {
      const int value = s.normal[i] + delta.normal[i];
      sound = sound && value >= 0 && value <= limit;
      out.normal[i] = static_cast<uint16_t>(std::clamp(value, 0, limit));
    }
  return sound;
}

AttributeDelta readAttributes(BitReader& in, const AttributeTables& tables, unsigned levelContext) {
  AttributeDelta out;
  const auto value = [&](unsigned valueClass) {
    return static_cast<int16_t>(readValue(in, valueClass));
  };
  if (tables.layout.colours) {
    const unsigned green = tables.green[levelContext].read(in);
    const unsigned context = colourContext(green);
    const unsigned red = tables.red[context].read(in);
    const unsigned blue = tables.blue[context].read(in);
    const unsigned alpha = tables.alpha.read(in);
    out.colour = {value(green), value(red), value(blue), value(alpha)};
  }
  if (const unsigned classes = tables.normalClasses(); classes != 0) {
    const unsigned joint = tables.normal[levelContext].read(in);
    out.normal = {value(joint / classes), value(joint % classes)};
  }
  return out;
}

void writeAttributes(BitWriter& out, const AttributeDelta& delta, const AttributeTables& tables,
                     unsigned levelContext) {
  if (tables.layout.colours) {
    const unsigned green = valueClassOf(delta.colour[0]);
    const unsigned context = colourContext(green);
    tables.green[levelContext].write(out, green);
    tables.red[context].write(out, valueClassOf(delta.colour[1]));
    tables.blue[context].write(out, valueClassOf(delta.colour[2]));
    tables.alpha.write(out, valueClassOf(delta.colour[3]));
    for (const int16_t value : delta.colour) writeValue(out, value);
  }
  if (const unsigned classes = tables.normalClasses(); classes != 0) {
    tables.normal[levelContext].write(
        out, valueClassOf(delta.normal[0]) * classes + valueClassOf(delta.normal[1]));
    for (const int16_t value : delta.normal) writeValue(out, value);
  }
}

AttributeBits attributeBits(const AttributeDelta& delta, const AttributeTables& tables,
                            unsigned levelContext) {
  AttributeBits bits;
  if (tables.layout.colours) {
    const unsigned green = valueClassOf(delta.colour[0]);
    bits.colour = tables.green[levelContext].length(green) +
                  tables.red[colourContext(green)].length(valueClassOf(delta.colour[1])) +
                  tables.blue[colourContext(green)].length(valueClassOf(delta.colour[2])) +
                  tables.alpha.length(valueClassOf(delta.colour[3]));
    for (const int16_t value : delta.colour) bits.colour += valueBits(value);
  }
  if (const unsigned classes = tables.normalClasses(); classes != 0) {
    bits.normal = tables.normal[levelContext].length(valueClassOf(delta.normal[0]) * classes +
                                                     valueClassOf(delta.normal[1]));
    for (const int16_t value : delta.normal) bits.normal += valueBits(value);
  }
  return bits;
}

AttributeStatistics::AttributeStatistics(const AttributeLayout& attributes) : layout(attributes) {
  forEachCode(*this,
              [](std::vector<uint64_t>& counts, size_t symbols) { counts.assign(symbols, 0); });
}

void AttributeStatistics::add(const AttributeDelta& delta, unsigned levelContext) {
  if (layout.colours) {
    const unsigned greenClass = valueClassOf(delta.colour[0]);
    const unsigned context = colourContext(greenClass);
    ++green[levelContext][greenClass];
    ++red[context][valueClassOf(delta.colour[1])];
    ++blue[context][valueClassOf(delta.colour[2])];
    ++alpha[valueClassOf(delta.colour[3])];
  }
  if (const unsigned classes = 2 * layout.normalBits; classes != 0)
    ++normal[levelContext][valueClassOf(delta.normal[0]) * classes + valueClassOf(delta.normal[1])];
}

AttributeTables AttributeStatistics::train() const {
  AttributeTables tables;
  tables.layout = layout;
  const auto trainAll = [](auto& codes, const auto& counts) {
    for (size_t i = 0; i < codes.size(); ++i) codes[i] = HuffmanCode::fromCounts(counts[i]);
  };
  trainAll(tables.green, green);
  trainAll(tables.red, red);
  trainAll(tables.blue, blue);
  tables.alpha = HuffmanCode::fromCounts(alpha);
  trainAll(tables.normal, normal);
  return tables;
}

void writeAttributeTables(BitWriter& out, const AttributeTables& tables) {
  out.writeBit(tables.layout.colours);
  out.write(tables.layout.normalBits, kNormalBitsBits);
  out.writeBit(false);  // no further attributes: the place where wedges will begin
  forEachCode(tables, [&](const HuffmanCode& code, size_t) { code.writeTo(out); });
}

bool readAttributeTables(BitReader& in, AttributeTables& tables) {
  tables.layout.colours = in.readBit();
  tables.layout.normalBits = static_cast<unsigned>(in.read(kNormalBitsBits));
  if (in.readBit()) return false;
  if (tables.layout.normalBits != 0 && tables.layout.normalBits < kMinNormalBits) return false;
  forEachCode(tables, [&](HuffmanCode& code, size_t symbols) {
    code = HuffmanCode::readFrom(in, symbols);
  });
  return true;
}

}  // namespace meshfront
