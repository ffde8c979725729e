#include "viewer/gl/pixel_counter.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "viewer/gl/shader_program.h"

namespace meshfront {
namespace {

// Three atomic additions a pixel. On llvmpipe, one addition a pixel on its triangle and a second
// pass over the triangles takes half the time at 70 thousand triangles, twice at two million, and a
// counter a triangle; merging runs of equal pixels first takes longer than it saves.
constexpr char kCountShader[] = R"(#version 450 core
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0, r32ui) uniform readonly uimage2D items;
layout(std430, binding = 0) readonly buffer Corners { uint corners[]; };
layout(std430, binding = 1) buffer Counts { uint counts[]; };
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(items)))) {
    return;
  }
  uint item = imageLoad(items, at).r;
  if (item == 0u) {
    return;
  }
  uint first = 3u * (item - 1u);
  atomicAdd(counts[corners[first]], 1u);
  atomicAdd(counts[corners[first + 1u]], 1u);
  atomicAdd(counts[corners[first + 2u]], 1u);
}
)";
constexpr GLuint kGroupSide = 16;  // pixels, as in the shader

}  // namespace

PixelCounter::Method PixelCounter::preferred(const GlContext& context) {
  return context.isSoftware() ? Method::readBack : Method::compute;
}

PixelCounter PixelCounter::create(Method wanted) {
  PixelCounter counter(wanted);
  if (wanted == Method::compute) {
    auto program = computeProgram("pixel count", kCountShader);
    if (program) {
      counter.program_ = std::move(*program);
      GLuint name = 0;
      glCreateBuffers(1, &name);
      counter.counts_ = GlBuffer(name);
    } else {
      counter.method_ = Method::readBack;
      counter.fallbackReason_ = program.error().message;
    }
  }
  return counter;
}

void PixelCounter::count(const RenderTarget& target, const GpuMesh& mesh,
                         std::vector<uint32_t>& counts) {
  if (method_ == Method::compute && mesh.fitsShaderStorage() && mesh.vertexCount() > 0) {
    countOnGpu(target, mesh, counts);
    return;
  }
  target.readItems(items_);
  countPixels(items_, mesh.corners(), mesh.vertexCount(), counts);
}

void PixelCounter::countOnGpu(const RenderTarget& target, const GpuMesh& mesh,
                              std::vector<uint32_t>& counts) {
  const size_t bytes = mesh.vertexCount() * sizeof(uint32_t);
  if (bytes > capacity_) {
    capacity_ = bytes + bytes / 2;
    glNamedBufferData(counts_.name(), static_cast<GLsizeiptr>(capacity_), nullptr, GL_DYNAMIC_READ);
  }
  const GLuint zero = 0;
  glClearNamedBufferSubData(counts_.name(), GL_R32UI, 0, static_cast<GLsizeiptr>(bytes),
                            GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
  glUseProgram(program_.name());
  glBindImageTexture(0, target.itemTexture(), 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, mesh.cornerBuffer());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, counts_.name());
  const auto width = static_cast<GLuint>(target.size().width);
  const auto height = static_cast<GLuint>(target.size().height);
  glDispatchCompute((width + kGroupSide - 1) / kGroupSide, (height + kGroupSide - 1) / kGroupSide,
                    1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  counts.resize(mesh.vertexCount());
  glGetNamedBufferSubData(counts_.name(), 0, static_cast<GLsizeiptr>(bytes), counts.data());
}

void countPixels(std::span<const uint32_t> items, std::span<const Triangle> corners,
                 size_t vertexCount, std::vector<uint32_t>& counts) {
  counts.assign(vertexCount, 0);
  size_t at = 0;
  while (at < items.size()) {
    const uint32_t item = items[at];
    const size_t begin = at;
    while (at < items.size() && items[at] == item) {
      ++at;
    }
    if (item == 0 || item > corners.size()) {
      continue;
    }
    for (const uint32_t vertex : corners[item - 1]) {
      if (vertex < vertexCount) {
        counts[vertex] += static_cast<uint32_t>(at - begin);
      }
    }
  }
}

}  // namespace meshfront
