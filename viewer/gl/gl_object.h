// Owners of OpenGL names. Create and destroy them while their context is current.
// No GL header here: what includes this is free to use any loader.
#pragma once

#include <utility>

struct __GLsync;

namespace meshfront {

using GlName = unsigned int;

enum class GlKind { buffer, texture, framebuffer, vertexArray, program, shader, query };

void deleteGlName(GlKind kind, GlName name);

// Moves, never copies. 0 = nothing.
template <GlKind kKind>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GlName name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  GlObject(const GlObject&) = delete;
  GlObject& operator=(const GlObject&) = delete;
  ~GlObject() {
    if (name_ != 0) {
      deleteGlName(kKind, name_);
    }
  }
  [[nodiscard]] GlName name() const { return name_; }

 private:
  GlName name_ = 0;
};

// The same for a fence, which has an address instead of a name.
class GlSync {
 public:
  GlSync() = default;
  explicit GlSync(__GLsync* sync) : sync_(sync) {}
  GlSync(GlSync&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}
  GlSync& operator=(GlSync&& other) noexcept {
    std::swap(sync_, other.sync_);
    return *this;
  }
  GlSync(const GlSync&) = delete;
  GlSync& operator=(const GlSync&) = delete;
  ~GlSync();
  [[nodiscard]] __GLsync* get() const { return sync_; }

 private:
  __GLsync* sync_ = nullptr;
};

using GlBuffer = GlObject<GlKind::buffer>;
using GlTexture = GlObject<GlKind::texture>;
using GlFramebuffer = GlObject<GlKind::framebuffer>;
using GlVertexArray = GlObject<GlKind::vertexArray>;
using GlProgram = GlObject<GlKind::program>;
using GlShader = GlObject<GlKind::shader>;
using GlQuery = GlObject<GlKind::query>;

}  // namespace meshfront
