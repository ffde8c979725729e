#include "shared/codec/answer.h"
#include "shared/store/entity_tag.h"
#include "tests/fuzz/fuzz_bases.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/seeds.h"

namespace meshfront::fuzz {
namespace {

constexpr const char* kForEver = "public, max-age=31536000, immutable, no-transform";
constexpr char kOk = 0;
constexpr char kOkWithChecksum = 8;
constexpr char kOkWithBase = 16;

std::string answer(char flags, const std::string& etag, const std::string& cacheControl,
                   const std::string& age, std::string_view content, size_t length) {
  std::string out(1, flags);
  out.append(etag).append("\n").append(cacheControl).append("\n").append(age).append("\n");
  out.push_back(static_cast<char>(length));
  out.push_back(static_cast<char>(length >> 8));
  return out.append(content);
}
std::string answer(char flags, const std::string& etag, const std::string& cacheControl,
                   const std::string& age, std::string_view content) {
  return answer(flags, etag, cacheControl, age, content, content.size());
}

// Records of the first roots of the base that takes nearly any bits.
std::string someRecords(const Expansion& expansion) {
  const BaseMesh& base = baseOf(2);
  std::vector<NodeId> wanted;
  for (uint32_t tree = 0; tree < base.roots.size() && wanted.size() < 3; ++tree)
    if (!base.roots[tree].isLeaf) wanted.push_back(NodeId::root(tree));
  const auto levelOf = [&](const NodeId& node) -> std::optional<unsigned> {
    return base.roots[node.tree].level;
  };
  for (size_t length = 1; length < 400; ++length)
    for (unsigned byte = 0; byte < 256; ++byte)
      for (const uint8_t last : {uint8_t{0}, static_cast<uint8_t>(byte)}) {
        std::vector<uint8_t> bytes(length, static_cast<uint8_t>(byte));
        bytes.back() = last;
        if (parseAnswer(withChecksum(bytes), wanted, expansion, base.tables, levelOf))
          return {bytes.begin(), bytes.end()};
      }
  return {};
}

}  // namespace

std::vector<Seed> upstreamSeeds(const std::string& metadata) {
  const std::string base = answer(kOkWithBase, "", kForEver, "3", "", 2);
  const std::string records = someRecords({});
  const std::string catalogue = "{\"meshes\":[]}";
  const auto tagOf = [](const std::string& text) {
    return documentTag({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  };
  const std::string list = answer(kOk, tagOf(catalogue), "public, max-age=10", "0", catalogue);
  const std::string mesh = answer(kOk, tagOf(metadata), "max-age=10", "", metadata);
  std::vector<Seed> seeds;
  const auto add = [&](const char* name, const std::string& content) {
    seeds.push_back({"upstream", name, content});
  };
  const std::string constant = answer(kOkWithChecksum, "", kForEver, "7", "constant");
  add("valid-records", base + answer(kOkWithChecksum, "", kForEver, "", records) + records);
  add("valid-catalogue", "\2\n\n\n" + std::string(2, '\0') + list + mesh + list + mesh);
  add("valid-not-modified", "\2\n\n\n" + std::string(2, '\0') + list + mesh +
                                answer(1, "", "max-age=10", "1", "") +
                                answer(1, "", "no-store", "99999999999999999999", ""));
  add("cut-records",
      base + answer(kOkWithChecksum, "", kForEver, "", records.substr(0, records.size() / 2)));
  add("other-tag",
      base + answer(kOkWithChecksum, "\"00000000-12-00000000\"", kForEver, "", records));
  add("statuses", base + answer(3, "", "", "", "") + answer(4, "", "", "-5", "x") + constant +
                      answer(5, "W/\"\"", "max-age=", "x", "y"));
  add("page", answer(kOk, "", "max-age=3600", "", "<html>") +
                  answer(kOk, "", "max-age=3600", "", "<html>"));
  return seeds;
}

}  // namespace meshfront::fuzz
