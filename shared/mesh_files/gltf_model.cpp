#include "shared/mesh_files/gltf_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "shared/mesh_files/not_carried.h"
#include "shared/mesh_files/vector_length.h"

namespace meshfront {
namespace {

using nlohmann::json;

constexpr size_t kGlbHeader = 12;
constexpr size_t kChunkHeader = 8;
constexpr uint32_t kJsonChunk = 0x4e4f534a;
constexpr uint32_t kBinaryChunk = 0x004e4942;
constexpr unsigned kDeepest = 64;  // nesting of JSON; glTF itself needs a dozen

uint32_t wordAt(std::string_view file, size_t at) {
  uint32_t word = 0;
  for (size_t i = 4; i-- > 0;) word = word << 8 | static_cast<uint8_t>(file[at + i]);
  return word;
}

// Where JSON opens more than kDeepest brackets, which would cost a hundred times its size.
std::optional<size_t> tooDeepAt(std::string_view text) {
  unsigned depth = 0;
  bool inText = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inText) {
      if (c == '\\') ++i;
      if (c == '"') inText = false;
    } else if (c == '"') {
      inText = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest) return i;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return std::nullopt;
}

// Extensions that may be required without changing a triangle.
bool isHarmless(std::string_view extension) {
  for (const std::string_view prefix :
       {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "EXT_lights_"})
    if (extension.starts_with(prefix)) return true;
  return extension == "KHR_mesh_quantization" || extension == "KHR_xmp_json_ld" ||
         extension == "EXT_mesh_features" || extension == "EXT_structural_metadata";
}

GltfTransform fromMatrix(const std::array<double, 16>& m) {
  return {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10], m[12], m[13], m[14]};
}

GltfTransform fromParts(const std::array<double, 3>& translation, std::array<double, 4> rotation,
                        const std::array<double, 3>& scale) {
  auto& [x, y, z, w] = rotation;
  const double length = lengthOf(rotation);
  if (length > 0 && length != 1)
    for (double& component : rotation) component /= length;
  if (!(length > 0)) rotation = {0, 0, 0, 1};
  return {(1 - 2 * (y * y + z * z)) * scale[0],
          2 * (x * y + z * w) * scale[0],
          2 * (x * z - y * w) * scale[0],
          2 * (x * y - z * w) * scale[1],
          (1 - 2 * (x * x + z * z)) * scale[1],
          2 * (y * z + x * w) * scale[1],
          2 * (x * z + y * w) * scale[2],
          2 * (y * z - x * w) * scale[2],
          (1 - 2 * (x * x + y * y)) * scale[2],
          translation[0],
          translation[1],
          translation[2]};
}

// Reads the document; the first thing that is wrong stays in problem_ and what follows is moot.
class ModelParser {
 public:
  explicit ModelParser(const json& document) : document_(document) {}

  Result<GltfModel> parse() {
    checkVersion();
    checkExtensions();
    for (const char* what : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes"})
      list(document_, what, "");
    if (!problem_.empty()) return fail(problem_);
    each("buffers", [&](const json& item, const std::string& place) {
      model_.buffers.push_back(
          {text(item, "uri", place), whole(item, "byteLength", place, std::nullopt)});
    });
    each("bufferViews", [&](const json& item, const std::string& place) {
      model_.bufferViews.push_back(bufferView(item, place));
    });
    each("accessors", [&](const json& item, const std::string& place) {
      model_.accessors.push_back(accessor(item, place));
    });
    each("meshes", [&](const json& item, const std::string& place) {
      GltfMesh mesh;
      eachOf(item, "primitives", place + ".", [&](const json& part, const std::string& partPlace) {
        mesh.primitives.push_back(primitive(part, partPlace));
      });
      model_.meshes.push_back(std::move(mesh));
    });
    each("nodes", [&](const json& item, const std::string& place) {
      model_.nodes.push_back(node(item, place));
    });
    each("scenes", [&](const json& item, const std::string& place) {
      model_.scenes.push_back(nodeNumbers(item, "nodes", place));
    });
    model_.scene = number(document_, "scene", "the document", "scenes");
    model_.materials = list(document_, "materials", "").size();
    model_.images = list(document_, "images", "").size();
    model_.skins = list(document_, "skins", "").size();
    model_.animations = list(document_, "animations", "").size();
    if (!problem_.empty()) return fail(problem_);
    return std::move(model_);
  }

 private:
  void wrong(const std::string& place, const std::string& what) {
    if (problem_.empty()) problem_ = place + ": " + what;
  }

  static const json* member(const json& object, const char* name) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
  }
  const json& list(const json& object, const char* name, const std::string& place) {
    static const json none = json::array();
    const json* value = member(object, name);
    if (value == nullptr) return none;
    if (value->is_array()) return *value;
    wrong(place + name, "not an array");
    return none;
  }
  template <typename Take>
  void eachOf(const json& object, const char* name, const std::string& before, const Take& take) {
    size_t i = 0;
    for (const json& item : list(object, name, before)) {
      if (!problem_.empty()) return;
      const std::string place = before + name + "[" + std::to_string(i++) + "]";
      if (!item.is_object()) return wrong(place, "not an object");
      take(item, place);
    }
  }
  template <typename Take>
  void each(const char* name, const Take& take) {
    eachOf(document_, name, "", take);
  }

  // A whole number of 0 .. 2^53; `otherwise` if there is none, or an error without such.
  uint64_t whole(const json& object, const char* name, const std::string& place,
                 std::optional<uint64_t> otherwise) {
    const json* value = member(object, name);
    if (value == nullptr) {
      if (!otherwise) wrong(place, std::string("lacks ") + name);
      return otherwise.value_or(0);
    }
    return whole(*value, place + "." + name);
  }
  uint64_t whole(const json& value, const std::string& place) {
    constexpr double kLimit = 0x1p53;
    if (value.is_number()) {
      const double number = value.get<double>();
      if (number >= 0 && number <= kLimit && std::floor(number) == number)
        return static_cast<uint64_t>(number);
    }
    wrong(place, "not a whole number");
    return 0;
  }
  // The number of one of the things in the document's list `of`.
  uint32_t number(const json& value, const std::string& place, const char* of) {
    const uint64_t number = whole(value, place);
    const size_t count = std::min<size_t>(list(document_, of, "").size(), UINT32_MAX);
    if (number < count) return static_cast<uint32_t>(number);
    wrong(place, "there is no " + std::string(of) + "[" + std::to_string(number) + "]");
    return 0;
  }
  std::optional<uint32_t> number(const json& object, const char* name, const std::string& place,
                                 const char* of) {
    const json* value = member(object, name);
    if (value == nullptr) return std::nullopt;
    return number(*value, place + "." + name, of);
  }
  uint32_t requiredNumber(const json& object, const char* name, const std::string& place,
                          const char* of) {
    const auto found = number(object, name, place, of);
    if (!found) wrong(place, std::string("lacks ") + name);
    return found.value_or(0);
  }
  std::vector<uint32_t> nodeNumbers(const json& object, const char* name,
                                    const std::string& place) {
    std::vector<uint32_t> numbers;
    for (const json& value : list(object, name, place + "."))
      numbers.push_back(number(value, place + "." + name, "nodes"));
    return numbers;
  }
  std::string text(const json& object, const char* name, const std::string& place) {
    const json* value = member(object, name);
    if (value == nullptr) return {};
    if (value->is_string()) return value->get<std::string>();
    wrong(place + "." + name, "not a text");
    return {};
  }
  template <size_t N>
  bool reals(const json& object, const char* name, const std::string& place,
             std::array<double, N>& out) {
    const json* value = member(object, name);
    if (value == nullptr) return false;
    bool right = value->is_array() && value->size() == N;
    for (size_t i = 0; right && i < N; ++i) {
      right = (*value)[i].is_number();
      if (right) out[i] = (*value)[i].template get<double>();
      right = right && std::isfinite(out[i]);
    }
    if (!right) wrong(place + "." + name, "not " + std::to_string(N) + " finite numbers");
    return right;
  }
  // The first of the named extensions that the object has.
  static std::string extensionOf(const json& object,
                                 std::initializer_list<const char*> extensions) {
    const json* all = member(object, "extensions");
    for (const char* extension : extensions)
      if (all != nullptr && member(*all, extension) != nullptr) return extension;
    return {};
  }

  void checkVersion() {
    const json* asset = member(document_, "asset");
    const std::string version = asset == nullptr ? std::string() : text(*asset, "version", "asset");
    if (!version.starts_with("2."))
      wrong("asset.version", version.empty()
                                 ? "not there; only glTF 2.0 is read"
                                 : "'" + printableName(version) + "', but only glTF 2.0 is read");
  }
  void checkExtensions() {
    for (const json& extension : list(document_, "extensionsRequired", "")) {
      const std::string name = extension.is_string() ? extension.get<std::string>() : "?";
      if (!isHarmless(name))
        wrong("extensionsRequired",
              "the extension " + printableName(name) + " is not read; save the mesh without it");
    }
  }

  GltfBufferView bufferView(const json& item, const std::string& place) {
    GltfBufferView view;
    view.buffer = requiredNumber(item, "buffer", place, "buffers");
    view.byteOffset = whole(item, "byteOffset", place, 0);
    view.byteLength = whole(item, "byteLength", place, std::nullopt);
    view.byteStride = whole(item, "byteStride", place, 0);
    view.compressedBy = extensionOf(item, {"EXT_meshopt_compression", "KHR_meshopt_compression"});
    return view;
  }

  GltfComponent component(const json& object, const std::string& place) {
    switch (whole(object, "componentType", place, std::nullopt)) {
      case 5120:
        return GltfComponent::int8;
      case 5121:
        return GltfComponent::uint8;
      case 5122:
        return GltfComponent::int16;
      case 5123:
        return GltfComponent::uint16;
      case 5125:
        return GltfComponent::uint32;
      case 5126:
        return GltfComponent::float32;
      default:
        wrong(place + ".componentType", "unknown");
        return GltfComponent::float32;
    }
  }

  GltfAccessor accessor(const json& item, const std::string& place) {
    GltfAccessor out;
    out.bufferView = number(item, "bufferView", place, "bufferViews");
    out.byteOffset = whole(item, "byteOffset", place, 0);
    out.componentType = component(item, place);
    const json* normalized = member(item, "normalized");
    out.normalized = normalized != nullptr && normalized->is_boolean() && normalized->get<bool>();
    out.count = whole(item, "count", place, std::nullopt);
    const std::string type = text(item, "type", place);
    if (type == "SCALAR")
      out.components = 1;
    else if (type.size() == 4 && type.starts_with("VEC") && type[3] >= '2' && type[3] <= '4')
      out.components = static_cast<unsigned>(type[3] - '0');
    else if (type.starts_with("MAT"))
      out.components = 0;
    else
      wrong(place + ".type", "unknown");
    if (const json* sparse = member(item, "sparse")) out.sparse = this->sparse(*sparse, place);
    return out;
  }

  GltfSparse sparse(const json& item, const std::string& accessorPlace) {
    const std::string place = accessorPlace + ".sparse";
    const json* indices = member(item, "indices");
    const json* values = member(item, "values");
    GltfSparse out;
    if (indices == nullptr || values == nullptr) {
      wrong(place, "lacks indices or values");
      return out;
    }
    out.count = whole(item, "count", place, std::nullopt);
    out.indicesView = requiredNumber(*indices, "bufferView", place + ".indices", "bufferViews");
    out.indicesOffset = whole(*indices, "byteOffset", place + ".indices", 0);
    out.indicesType = component(*indices, place + ".indices");
    out.valuesView = requiredNumber(*values, "bufferView", place + ".values", "bufferViews");
    out.valuesOffset = whole(*values, "byteOffset", place + ".values", 0);
    return out;
  }

  GltfPrimitive primitive(const json& item, const std::string& place) {
    GltfPrimitive out;
    out.mode = whole(item, "mode", place, 4);
    if (out.mode > 6) wrong(place + ".mode", "unknown");
    out.indices = number(item, "indices", place, "accessors");
    out.morphTargets = list(item, "targets", place + ".").size();
    out.compressedBy = extensionOf(item, {"KHR_draco_mesh_compression"});
    const json* attributes = member(item, "attributes");
    if (attributes == nullptr || !attributes->is_object()) {
      wrong(place, "lacks attributes");
      return out;
    }
    for (const auto& [name, value] : attributes->items()) {
      const uint32_t accessor = number(value, place + ".attributes", "accessors");
      if (name == "POSITION")
        out.position = accessor;
      else if (name == "NORMAL")
        out.normal = accessor;
      else if (name == "COLOR_0")
        out.colour = accessor;
      else if (name.starts_with("TEXCOORD_"))
        out.hasTextureCoordinates = true;
      else
        out.otherAttributes.push_back(printableName(name));
    }
    return out;
  }

  GltfNode node(const json& item, const std::string& place) {
    GltfNode out;
    out.children = nodeNumbers(item, "children", place);
    out.mesh = number(item, "mesh", place, "meshes");
    out.hasSkin = member(item, "skin") != nullptr;
    out.hasInstances = !extensionOf(item, {"EXT_mesh_gpu_instancing"}).empty();
    std::array<double, 16> matrix{};
    if (reals(item, "matrix", place, matrix)) {
      out.transform = fromMatrix(matrix);
      return out;
    }
    std::array<double, 3> translation{};
    std::array<double, 4> rotation = {0, 0, 0, 1};
    std::array<double, 3> scale = {1, 1, 1};
    reals(item, "translation", place, translation);
    reals(item, "rotation", place, rotation);
    reals(item, "scale", place, scale);
    out.transform = fromParts(translation, rotation, scale);
    return out;
  }

  const json& document_;
  GltfModel model_;
  std::string problem_;
};

}  // namespace

Result<GltfChunks> splitGltf(std::string_view file) {
  if (!file.starts_with("glTF")) return GltfChunks{file, 0, std::nullopt};
  if (file.size() < kGlbHeader + kChunkHeader)
    return fail("byte " + std::to_string(file.size()) + ": the file ends within the GLB header");
  if (wordAt(file, 4) != 2)
    return fail("byte 4: GLB of version " + std::to_string(wordAt(file, 4)) +
                ", but only version 2 is read");
  const size_t length = wordAt(file, 8);
  if (length > file.size())
    return fail("byte " + std::to_string(file.size()) +
                ": the file ends early, its header promises " + std::to_string(length) + " bytes");
  GltfChunks chunks;
  bool hasJson = false;
  for (size_t at = kGlbHeader; at + kChunkHeader <= length;) {
    const size_t size = wordAt(file, at);
    const uint32_t type = wordAt(file, at + 4);
    const size_t start = at + kChunkHeader;
    if (size > length - start)
      return fail("byte " + std::to_string(at) + ": a chunk of " + std::to_string(size) +
                  " bytes, but " + std::to_string(length - start) + " are left");
    if (type == kJsonChunk && !hasJson) {
      chunks.json = file.substr(start, size);
      chunks.jsonOffset = start;
      hasJson = true;
    } else if (type == kBinaryChunk && !chunks.binary) {
      chunks.binary = file.substr(start, size);
    }
    at = start + size;
  }
  if (!hasJson) return fail("byte 12: the GLB file has no JSON chunk");
  return chunks;
}

Result<GltfModel> parseGltfModel(const GltfChunks& chunks) {
  const auto place = [&](size_t at) {
    return "byte " + std::to_string(chunks.jsonOffset + std::min(at, chunks.json.size())) + ": ";
  };
  if (const auto at = tooDeepAt(chunks.json)) return fail(place(*at) + "JSON nested too deeply");
  json document;
  try {
    document = json::parse(chunks.json.begin(), chunks.json.end());
  } catch (const json::parse_error& error) {
    return fail(place(error.byte > 0 ? error.byte - 1 : 0) + "broken JSON");
  } catch (const json::exception&) {
    return fail(place(0) + "JSON with a number that is too large");
  }
  if (!document.is_object()) return fail(place(0) + "not a glTF document");
  return ModelParser(document).parse();
}

}  // namespace meshfront
