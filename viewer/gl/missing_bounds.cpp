#include "viewer/gl/missing_bounds.h"

#include <epoxy/gl.h>

#include <cmath>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <string>

#include "viewer/gl/colour_scales.h"
#include "viewer/gl/shader_program.h"
#include "viewer/gl/update_upload.h"

namespace meshfront {
namespace {

static_assert(kRestBytes == 36 && offsetof(DrawnVertex, level) - kPositionBytes == 28,
              "the shader counts on it");

constexpr GLuint kGroupSize = 64;
constexpr GLuint kMostGroups = 65'535;
constexpr GLuint kSizes = 16;     // powers of two of pixels
constexpr GLuint kSegments = 40;  // of a circle
constexpr size_t kCircleBytes = 4 * sizeof(float);

// One program to count the circles by size (MEASURE), one to choose those of the sizes that fit.
constexpr char kChooseShader[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Positions { int positions[]; };
layout(std430, binding = 1) readonly buffer Rest { uint rest[]; };
layout(std430, binding = 2) readonly buffer Pixels { uint pixels[]; };
layout(std430, binding = 3) readonly buffer Radii { float radii[256]; };
layout(std430, binding = 4) buffer Sizes { uint sizes[16]; uint taken; };
layout(std430, binding = 5) writeonly buffer Circles { vec4 circles[]; };
layout(std430, binding = 6) buffer Command { uint vertices; uint instances; uint first[2]; };
layout(location = 0) uniform uint slots;
layout(location = 1) uniform ivec3 anchor;
layout(location = 2) uniform mat4 clipFromGrid;
layout(location = 3) uniform float pixelsAtOne;  // of a mesh unit, at distance 1
layout(location = 4) uniform float smallest;     // pixels
layout(location = 5) uniform uint most;

void look(uint slot) {
  uint state = rest[9u * slot + 7u];
  if (pixels[slot] == 0u || (state >> 8 & 255u) != 0u) {
    return;
  }
  ivec3 p = ivec3(positions[3u * slot], positions[3u * slot + 1u], positions[3u * slot + 2u]);
  vec4 c = clipFromGrid * vec4(vec3(p - anchor), 1.0);
  if (c.w <= 0.0) {
    return;
  }
  uint level = state & 255u;
  float radius = radii[level] * pixelsAtOne / c.w;
  if (!(radius >= smallest)) {
    return;
  }
  int size = clamp(int(log2(radius)), 0, 15);
#ifdef MEASURE
  atomicAdd(sizes[size], 1u);
#else
  // The smallest size down to which all fit; of the largest there is as many as fit in any case.
  uint larger = 0u;
  for (int s = 15; s > size; --s) {
    larger += sizes[s];
  }
  if (larger > 0u && larger + sizes[size] > most) {
    return;
  }
  uint place = atomicAdd(taken, 1u);
  if (place < most) {
    circles[place] = vec4(c.xy / c.w, radius, float(level));
    atomicAdd(instances, 1u);
  }
#endif
}

void main() {
  for (uint slot = gl_GlobalInvocationID.x; slot < slots;
       slot += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    look(slot);
  }
}
)";

constexpr char kCircleVertexShader[] = R"(
layout(location = 0) in vec4 circle;  // centre, radius in pixels, level
uniform vec2 halfPicture;             // pixels
uniform uint finestLevel;
out vec3 shown;
void main() {
  float turn = float((gl_VertexID + 1) / 2) / 40.0;
  vec2 at = vec2(cos(6.2831853 * turn), sin(6.2831853 * turn)) * circle.z / halfPicture;
  gl_Position = vec4(circle.xy + at, 0.5, 1.0);
  shown = missingColour(uint(circle.w), finestLevel, false);
}
)";

constexpr char kCircleFragmentShader[] = R"(#version 450 core
in vec3 shown;
layout(location = 0) out vec4 colour;
void main() {
  colour = vec4(pow(shown * 0.8, vec3(1.0 / 2.2)), 0.8);
}
)";

GlBuffer newStorage(size_t bytes) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
  return GlBuffer(name);
}

}  // namespace

Result<MissingBounds> MissingBounds::create() {
  const std::string version = "#version 450 core\n";
  auto measure = computeProgram("sizes of circles", version + "#define MEASURE\n" + kChooseShader);
  if (!measure) return tl::unexpected(measure.error());
  auto choose = computeProgram("choice of circles", version + kChooseShader);
  if (!choose) return tl::unexpected(choose.error());
  auto draw = drawProgram("circles", version + kColourScaleShader + kCircleVertexShader,
                          kCircleFragmentShader);
  if (!draw) return tl::unexpected(draw.error());
  MissingBounds made;
  made.measure_ = std::move(*measure);
  made.choose_ = std::move(*choose);
  made.draw_ = std::move(*draw);
  made.radii_ = newStorage(sizeof(LevelRadii));
  made.sizes_ = newStorage((kSizes + 1) * sizeof(GLuint));
  made.circles_ = newStorage(kMost * kCircleBytes);
  made.command_ = newStorage(4 * sizeof(GLuint));
  GLuint vao = 0;
  glCreateVertexArrays(1, &vao);
  made.vertexArray_ = GlVertexArray(vao);
  glVertexArrayVertexBuffer(vao, 0, made.circles_.name(), 0, kCircleBytes);
  glVertexArrayBindingDivisor(vao, 0, 1);
  glEnableVertexArrayAttrib(vao, 0);
  glVertexArrayAttribFormat(vao, 0, 4, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vao, 0, 0);
  return made;
}

void MissingBounds::choose(const MeshInstance& instance, const LevelRadii& radii, GlName pixels,
                           const Projection& projection, PixelSize size) const {
  const GpuMesh& mesh = *instance.mesh;
  const InstanceView place = InstanceView::of(instance, projection);
  const std::array<GLuint, kSizes + 1> none{};
  const std::array<GLuint, 4> command = {2 * kSegments, 0, 0, 0};
  glNamedBufferSubData(radii_.name(), 0, sizeof radii, radii.data());
  glNamedBufferSubData(sizes_.name(), 0, sizeof none, none.data());
  glNamedBufferSubData(command_.name(), 0, sizeof command, command.data());
  GLuint binding = 0;
  for (const GlName buffer : {mesh.positionBuffer(), mesh.restBuffer(), pixels, radii_.name(),
                              sizes_.name(), circles_.name(), command_.name()})
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding++, buffer);
  const glm::mat4 clip(place.clipFromGrid);
  const double worldUnit = place.worldStep / mesh.quantization().step;
  const double pixelsAtOne =
      worldUnit * 0.5 * size.height / std::tan(0.5 * projection.camera.verticalFov);
  const auto slots = static_cast<GLuint>(mesh.vertexCount());
  for (const GlName program : {measure_.name(), choose_.name()}) {
    glUseProgram(program);
    glProgramUniform1ui(program, 0, slots);
    glProgramUniform3i(program, 1, place.anchor[0], place.anchor[1], place.anchor[2]);
    glProgramUniformMatrix4fv(program, 2, 1, GL_FALSE, glm::value_ptr(clip));
    glProgramUniform1f(program, 3, static_cast<float>(pixelsAtOne));
    glProgramUniform1f(program, 4, kSmallestRadius);
    if (program == choose_.name()) glProgramUniform1ui(program, 5, kMost);
    glDispatchCompute(std::min((slots + kGroupSize - 1) / kGroupSize, kMostGroups), 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT |
                    GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  }
}

void MissingBounds::draw(RenderTarget& target, std::span<const MeshInstance> instances,
                         std::span<const LevelRadii> radii, PixelBuffers& pixels,
                         const Camera& camera, const Bounds& bounds, unsigned finestLevel,
                         double aspect) const {
  const PixelSize size = target.size();
  const Projection projection =
      Projection::fit(camera, bounds, aspect > 0 ? aspect : size.aspect());
  const GLenum attachment = GL_COLOR_ATTACHMENT0;
  glNamedFramebufferDrawBuffers(target.framebuffer(), 1, &attachment);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
  glViewport(0, 0, size.width, size.height);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  const GlName name = draw_.name();
  glProgramUniform2f(name, glGetUniformLocation(name, "halfPicture"),
                     0.5F * static_cast<float>(size.width), 0.5F * static_cast<float>(size.height));
  glProgramUniform1ui(name, glGetUniformLocation(name, "finestLevel"), finestLevel);
  for (size_t i = 0; i < std::min(instances.size(), radii.size()); ++i) {
    const GpuMesh& mesh = *instances[i].mesh;
    if (mesh.vertexCount() == 0 || !mesh.fitsShaderStorage()) continue;
    const GlName counted = pixels.buffer(i, mesh.vertexCount());
    if (counted == 0) continue;
    choose(instances[i], radii[i], counted, projection, size);
    glUseProgram(name);
    glBindVertexArray(vertexArray_.name());
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, command_.name());
    glDrawArraysIndirect(GL_LINES, nullptr);
  }
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

}  // namespace meshfront
