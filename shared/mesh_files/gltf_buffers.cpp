#include "shared/mesh_files/gltf_buffers.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "shared/mesh_files/file_bytes.h"
#include "shared/mesh_files/not_carried.h"

namespace meshfront {
namespace {

// An accessor without bytes costs memory that no byte of the file stands for.
constexpr uint64_t kMostZeros = uint64_t{1} << 20;

size_t byteLength(GltfComponent type) {
  switch (type) {
    case GltfComponent::int8:
    case GltfComponent::uint8:
      return 1;
    case GltfComponent::int16:
    case GltfComponent::uint16:
      return 2;
    case GltfComponent::uint32:
    case GltfComponent::float32:
      return 4;
  }
  return 4;
}

template <typename T>
double load(const char* at) {
  T value{};
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

double component(const char* at, GltfComponent type, bool normalized) {
  switch (type) {
    case GltfComponent::int8:
      return normalized ? std::max(load<int8_t>(at) / INT8_MAX, -1.0) : load<int8_t>(at);
    case GltfComponent::uint8:
      return normalized ? load<uint8_t>(at) / UINT8_MAX : load<uint8_t>(at);
    case GltfComponent::int16:
      return normalized ? std::max(load<int16_t>(at) / INT16_MAX, -1.0) : load<int16_t>(at);
    case GltfComponent::uint16:
      return normalized ? load<uint16_t>(at) / UINT16_MAX : load<uint16_t>(at);
    case GltfComponent::uint32:
      return load<uint32_t>(at);
    case GltfComponent::float32:
      return load<float>(at);
  }
  return 0;
}

int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  return c == '/' || c == '_' ? 63 : -1;
}

std::optional<std::string> decodeBase64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string out;
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  unsigned held = 0;
  for (const char c : text) {
    const int digit = base64Digit(c);
    if (digit < 0) return std::nullopt;
    bits = (bits << 6 | static_cast<uint32_t>(digit)) & 0xffffff;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += static_cast<char>(bits >> held);
  }
  return out;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// "a%20b" is "a b"; what is no escape stays as it is.
std::string withoutEscapes(std::string_view uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    const int high = i + 2 < uri.size() && uri[i] == '%' ? hexDigit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hexDigit(uri[i + 2]) : -1;
    if (low >= 0) {
      out += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

bool liesIn(const std::filesystem::path& folder, const std::filesystem::path& file) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

// Whether count elements of `size` bytes, `stride` apart, lie within `bytes` behind offset.
bool fits(uint64_t bytes, uint64_t offset, uint64_t count, uint64_t stride, uint64_t size) {
  if (offset > bytes) return false;
  if (count == 0) return true;
  const uint64_t left = bytes - offset;
  return left >= size && count - 1 <= (left - size) / stride;
}

std::string numbered(const char* what, uint64_t number) {
  return std::string(what) + "[" + std::to_string(number) + "]";
}

}  // namespace

double GltfValues::at(uint64_t element, unsigned part) const {
  const size_t offset = part * byteLength(type_);
  if (!overrides_.empty()) {
    const auto found =
        std::lower_bound(overrides_.begin(), overrides_.end(), element,
                         [](const Override& o, uint64_t wanted) { return o.element < wanted; });
    if (found != overrides_.end() && found->element == element)
      return component(found->bytes + offset, type_, normalized_);
  }
  if (data_ == nullptr) return 0;
  return component(data_ + element * stride_ + offset, type_, normalized_);
}

Result<GltfValues> GltfBuffers::open(uint32_t number) {
  const GltfAccessor& accessor = model_.accessors[number];
  const std::string place = numbered("accessors", number) + ": ";
  if (accessor.components == 0) return fail(place + "a matrix cannot stand here");
  GltfValues values;
  values.count_ = accessor.count;
  values.components_ = accessor.components;
  values.type_ = accessor.componentType;
  values.normalized_ = accessor.normalized;
  const size_t size = byteLength(accessor.componentType) * accessor.components;
  if (accessor.bufferView) {
    const auto bytes = view(*accessor.bufferView);
    if (!bytes) return tl::unexpected(bytes.error());
    const uint64_t stride = model_.bufferViews[*accessor.bufferView].byteStride;
    if (stride != 0 && stride < size)
      return fail(numbered("bufferViews", *accessor.bufferView) + ": a byteStride of " +
                  std::to_string(stride) + " for elements of " + std::to_string(size) + " bytes");
    values.stride_ = stride == 0 ? size : stride;
    if (!fits(bytes->size(), accessor.byteOffset, accessor.count, values.stride_, size))
      return fail(place + std::to_string(accessor.count) + " elements, but " +
                  numbered("bufferViews", *accessor.bufferView) + " ends early");
    values.data_ = bytes->data() + accessor.byteOffset;
  } else if (accessor.count > kMostZeros) {
    return fail(ErrorCode::tooLarge, place + std::to_string(accessor.count) +
                                         " elements without a bufferView, more than " +
                                         std::to_string(kMostZeros));
  }
  if (accessor.sparse)
    if (auto done = openSparse(accessor, place, values); !done) return tl::unexpected(done.error());
  return values;
}

Result<void> GltfBuffers::openSparse(const GltfAccessor& accessor, const std::string& place,
                                     GltfValues& values) {
  const GltfSparse& sparse = *accessor.sparse;
  const auto indices = view(sparse.indicesView);
  if (!indices) return tl::unexpected(indices.error());
  const auto replaced = view(sparse.valuesView);
  if (!replaced) return tl::unexpected(replaced.error());
  const size_t size = byteLength(accessor.componentType) * accessor.components;
  const size_t indexSize = byteLength(sparse.indicesType);
  if (!fits(indices->size(), sparse.indicesOffset, sparse.count, indexSize, indexSize) ||
      !fits(replaced->size(), sparse.valuesOffset, sparse.count, size, size))
    return fail(place + "sparse: a bufferView ends early");
  values.overrides_.reserve(sparse.count);
  for (uint64_t i = 0; i < sparse.count; ++i) {
    const double index = component(indices->data() + sparse.indicesOffset + i * indexSize,
                                   sparse.indicesType, false);
    const bool inOrder = index >= 0 && index < static_cast<double>(accessor.count) &&
                         (i == 0 || index > static_cast<double>(values.overrides_.back().element));
    if (!inOrder)
      return fail(place + "sparse: index " + std::to_string(i) +
                  " is out of range or not in order");
    values.overrides_.push_back(
        {static_cast<uint64_t>(index), replaced->data() + sparse.valuesOffset + i * size});
  }
  return {};
}

Result<std::string_view> GltfBuffers::view(uint32_t number) {
  const GltfBufferView& wanted = model_.bufferViews[number];
  const std::string place = numbered("bufferViews", number) + ": ";
  // Such a view may have a twin without compression; most have not.
  if (!wanted.compressedBy.empty() && model_.buffers[wanted.buffer].uri.empty())
    return fail(place + "compressed by the extension " + wanted.compressedBy +
                ", which is not read; save the mesh without it");
  const auto bytes = buffer(wanted.buffer);
  if (!bytes) return tl::unexpected(bytes.error());
  if (wanted.byteOffset > bytes->size() || wanted.byteLength > bytes->size() - wanted.byteOffset)
    return fail(place + std::to_string(wanted.byteLength) + " bytes from byte " +
                std::to_string(wanted.byteOffset) + ", but " + numbered("buffers", wanted.buffer) +
                " has " + std::to_string(bytes->size()));
  return bytes->substr(wanted.byteOffset, wanted.byteLength);
}

Result<std::string_view> GltfBuffers::buffer(uint32_t number) {
  if (kept_[number]) return *kept_[number];
  const GltfBuffer& wanted = model_.buffers[number];
  const std::string place = numbered("buffers", number) + ": ";
  std::string_view bytes;
  if (wanted.uri.empty()) {
    if (number != 0 || !binary_) return fail(place + "has neither a uri nor a binary chunk");
    bytes = *binary_;
  } else if (wanted.uri.starts_with("data:")) {
    const size_t comma = wanted.uri.find(";base64,");
    auto decoded = comma == std::string::npos
                       ? std::nullopt
                       : decodeBase64(std::string_view(wanted.uri).substr(comma + 8));
    if (!decoded) return fail(place + "a data URI that is not base64");
    decoded_.push_back(std::make_unique<const std::string>(std::move(*decoded)));
    bytes = *decoded_.back();
  } else {
    const auto file = fileBeside(wanted.uri);
    if (!file) return fail(file.error().code, place + file.error().message);
    bytes = *file;
  }
  if (wanted.byteLength > bytes.size())
    return fail(place + "ends early, at byte " + std::to_string(bytes.size()) + " of " +
                std::to_string(wanted.byteLength));
  kept_[number] = bytes.substr(0, wanted.byteLength);
  return *kept_[number];
}

Result<std::string_view> GltfBuffers::fileBeside(const std::string& uri) {
  const std::string shown = "'" + printableName(uri) + "' ";
  if (!folder_) return fail(shown + "is another file, and only one is at hand");
  const std::string name = withoutEscapes(uri);
  if (name.find('\0') != std::string::npos || name.find("://") != std::string::npos)
    return fail(shown + "is not the name of a file in the mesh's folder");
  // Symbolic links count as what they point to: the file must really lie in the folder.
  std::error_code error;
  const auto folder = std::filesystem::canonical(*folder_, error);
  const auto path = error ? *folder_ : std::filesystem::canonical(*folder_ / name, error);
  if (error) return fail(ErrorCode::notFound, shown + "is not in the mesh's folder");
  if (!liesIn(folder, path)) return fail(shown + "lies outside the mesh's folder");
  if (!std::filesystem::is_regular_file(path, error)) return fail(shown + "is no file");
  auto& file = files_[path];
  if (file == nullptr) {
    auto bytes = readFileBytes(path);
    if (!bytes) return tl::unexpected(bytes.error());
    file = std::make_unique<const std::string>(std::move(*bytes));
  }
  return std::string_view(*file);
}

}  // namespace meshfront
