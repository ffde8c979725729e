// The bytes behind a glTF document: its buffers, wherever they are, and accessors on them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/mesh_files/gltf_model.h"

namespace meshfront {

// The elements of an accessor. Points into the buffers it was opened on.
class GltfValues {
 public:
  [[nodiscard]] uint64_t count() const { return count_; }
  [[nodiscard]] unsigned components() const { return components_; }
  [[nodiscard]] GltfComponent type() const { return type_; }

  // As stored; if the accessor is normalized, made a number of 0 .. 1 or -1 .. 1. Requires: element
  // < count(), component < components().
  [[nodiscard]] double at(uint64_t element, unsigned component) const;

 private:
  friend class GltfBuffers;
  struct Override {
    uint64_t element;
    const char* bytes;
  };
  const char* data_ = nullptr;  // none: zeros
  uint64_t count_ = 0;
  size_t stride_ = 0;
  unsigned components_ = 0;
  GltfComponent type_ = GltfComponent::float32;
  bool normalized_ = false;
  std::vector<Override> overrides_;  // of a sparse accessor, by element
};

// Buffers are fetched when an accessor needs them: the file's own binary chunk, data URIs, and
// files in the document's folder (or below it, never elsewhere). Keeps them.
class GltfBuffers {
 public:
  // Without a folder, buffers in other files are Errors. `model` and `binary` must outlive this.
  GltfBuffers(const GltfModel& model, std::optional<std::string_view> binary,
              std::optional<std::filesystem::path> folder)
      : model_(model), binary_(binary), folder_(std::move(folder)), kept_(model.buffers.size()) {}

  // Makes sure that all the accessor's elements lie within its buffer. Errors name the thing that
  // is wrong ("bufferViews[3]: ..."). Requires: accessor < model.accessors.size().
  [[nodiscard]] Result<GltfValues> open(uint32_t accessor);

 private:
  [[nodiscard]] Result<std::string_view> buffer(uint32_t number);
  [[nodiscard]] Result<std::string_view> view(uint32_t number);
  [[nodiscard]] Result<std::string_view> fileBeside(const std::string& uri);
  [[nodiscard]] Result<void> openSparse(const GltfAccessor& accessor, const std::string& place,
                                        GltfValues& values);

  const GltfModel& model_;
  std::optional<std::string_view> binary_;
  std::optional<std::filesystem::path> folder_;
  std::vector<std::optional<std::string_view>> kept_;  // by buffer
  std::map<std::filesystem::path, std::unique_ptr<const std::string>> files_;
  std::vector<std::unique_ptr<const std::string>> decoded_;  // data URIs
};

}  // namespace meshfront
