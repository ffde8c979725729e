#include "shared/store/mesh_metadata.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace meshfront {
namespace {

using nlohmann::json;

constexpr size_t kMaxNameLength = 64;
constexpr size_t kRevisionLength = 32;

bool isLetterOrDigit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

json linksOf(const MeshMetadata& m) {
  const std::string self = "/v1/meshes/" + m.name;
  const std::string fixed = self + "/" + m.revision;
  return {{"self", self},
          {"base", fixed + "/base"},
          {"splits", fixed + "/splits/{ids}{?levels,significance}"},
          {"querySplits", fixed + "/splits{?levels,significance}"},
          {"chunks", fixed + "/chunks"},
          {"chunk", fixed + "/chunks/{n}"}};
}

// Reads members one after another; keeps the first complaint.
class Members {
 public:
  explicit Members(const json& object) : object_(object) {}

  template <typename Integer>
  void count(const char* key, Integer& value) {
    const json* member = find(key);
    if (member == nullptr) return;
    if (!member->is_number_unsigned() ||
        member->get<uint64_t>() > std::numeric_limits<Integer>::max()) {
      complain(key, "must be a whole number in range");
    } else {
      value = static_cast<Integer>(member->get<uint64_t>());
    }
  }
  void text(const char* key, std::string& value) {
    const json* member = find(key);
    if (member == nullptr) return;
    if (member->is_string()) {
      value = member->get<std::string>();
    } else {
      complain(key, "must be a text");
    }
  }
  void number(const char* key, double& value) {
    const json* member = find(key);
    if (member == nullptr) return;
    if (member->is_number()) {
      value = member->get<double>();
    } else {
      complain(key, "must be a number");
    }
  }
  void point(const char* key, std::array<double, 3>& value) {
    const json* member = find(key);
    if (member == nullptr) return;
    const auto isNumber = [](const json& v) { return v.is_number(); };
    if (!member->is_array() || member->size() != 3 ||
        !std::all_of(member->begin(), member->end(), isNumber)) {
      complain(key, "must be three numbers");
      return;
    }
    for (size_t i = 0; i < 3; ++i) value[i] = (*member)[i].get<double>();
  }
  void texts(const char* key, std::vector<std::string>& value) {
    const json* member = find(key);
    if (member == nullptr) return;
    const auto isText = [](const json& v) { return v.is_string(); };
    if (!member->is_array() || !std::all_of(member->begin(), member->end(), isText)) {
      complain(key, "must be a list of texts");
      return;
    }
    value = member->get<std::vector<std::string>>();
  }
  // An empty object when it is missing, after a complaint.
  const json& object(const char* key) {
    static const json kEmpty = json::object();
    const json* member = find(key);
    if (member == nullptr) return kEmpty;
    if (member->is_object()) return *member;
    complain(key, "must be an object");
    return kEmpty;
  }
  void complain(const char* key, const char* what) {
    if (complaint_.empty()) complaint_ = std::string("mesh metadata: \"") + key + "\" " + what;
  }
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 private:
  const json* find(const char* key) {
    const auto it = object_.find(key);
    if (it != object_.end()) return &*it;
    complain(key, "is missing");
    return nullptr;
  }
  const json& object_;
  std::string complaint_;
};

}  // namespace

bool isMeshName(std::string_view name) {
  if (name.empty() || name.size() > kMaxNameLength || name.front() == '.') return false;
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return isLetterOrDigit(c) || c == '.' || c == '_' || c == '-'; });
}

bool isRevision(std::string_view revision) {
  return revision.size() == kRevisionLength &&
         std::all_of(revision.begin(), revision.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string toJson(const MeshMetadata& m) {
  const json out = {
      {"name", m.name},
      {"revision", m.revision},
      {"vertexCount", m.vertexCount},
      {"triangleCount", m.triangleCount},
      {"baseVertexCount", m.baseVertexCount},
      {"baseTriangleCount", m.baseTriangleCount},
      {"splitCount", m.splitCount},
      {"maxLevel", m.maxLevel},
      {"maxDepth", m.maxDepth},
      {"quantization",
       {{"bits", m.quantization.bits},
        {"origin", m.quantization.origin},
        {"step", m.quantization.step}}},
      {"bounds", {{"min", m.boundsMin}, {"max", m.boundsMax}}},
      {"attributes", m.attributes},
      {"baseBytes", m.baseBytes},
      {"recordBytes", m.recordBytes},
      {"chunkBytes", m.chunkBytes},
      {"chunkCount", m.chunkCount},
      {"links", linksOf(m)},
  };
  // Without blanks: these octets stand before the first picture.
  return out.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string catalogueJson(std::span<const MeshMetadata> meshes) {
  json list = json::array();
  for (const MeshMetadata& m : meshes)
    list.push_back({{"name", m.name},
                    {"revision", m.revision},
                    {"vertexCount", m.vertexCount},
                    {"triangleCount", m.triangleCount},
                    {"links", {{"self", "/v1/meshes/" + m.name}}}});
  return json{{"meshes", list}}.dump(2) + "\n";
}

Result<MeshMetadata> metadataFromJson(std::string_view text) {
  const json in = json::parse(text, nullptr, false);
  if (in.is_discarded() || !in.is_object()) return fail("mesh metadata: not a JSON object");
  MeshMetadata m;
  Members members(in);
  members.text("name", m.name);
  members.text("revision", m.revision);
  members.count("vertexCount", m.vertexCount);
  members.count("triangleCount", m.triangleCount);
  members.count("baseVertexCount", m.baseVertexCount);
  members.count("baseTriangleCount", m.baseTriangleCount);
  members.count("splitCount", m.splitCount);
  members.count("maxLevel", m.maxLevel);
  members.count("maxDepth", m.maxDepth);
  members.texts("attributes", m.attributes);
  members.count("baseBytes", m.baseBytes);
  members.count("recordBytes", m.recordBytes);
  members.count("chunkBytes", m.chunkBytes);
  members.count("chunkCount", m.chunkCount);
  Members grid(members.object("quantization"));
  Members bounds(members.object("bounds"));
  if (!members.complaint().empty()) return fail(members.complaint());
  grid.count("bits", m.quantization.bits);
  grid.point("origin", m.quantization.origin);
  grid.number("step", m.quantization.step);
  bounds.point("min", m.boundsMin);
  bounds.point("max", m.boundsMax);
  if (m.quantization.bits < kMinQuantizationBits || m.quantization.bits > kMaxQuantizationBits)
    grid.complain("bits", "must be 8 to 20");
  if (!std::isfinite(m.quantization.step) || m.quantization.step <= 0)
    grid.complain("step", "must be a positive number");
  if (!isMeshName(m.name)) grid.complain("name", "must be 1 to 64 of A-Z a-z 0-9 . _ -");
  if (!isRevision(m.revision)) grid.complain("revision", "must be 32 lower-case hex digits");
  if (!grid.complaint().empty()) return fail(grid.complaint());
  if (!bounds.complaint().empty()) return fail(bounds.complaint());
  return m;
}

}  // namespace meshfront
