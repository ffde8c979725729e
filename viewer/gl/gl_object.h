// Owners of OpenGL names. Create and destroy them while their context is current.
// No GL header here: what includes this is free to use any loader.
#pragma once

#include <utility>

namespace meshfront {

using GlName = unsigned int;

enum class GlKind { buffer, texture, framebuffer, vertexArray, program, shader };

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

using GlBuffer = GlObject<GlKind::buffer>;
using GlTexture = GlObject<GlKind::texture>;
using GlFramebuffer = GlObject<GlKind::framebuffer>;
using GlVertexArray = GlObject<GlKind::vertexArray>;
using GlProgram = GlObject<GlKind::program>;
using GlShader = GlObject<GlKind::shader>;

}  // namespace meshfront
