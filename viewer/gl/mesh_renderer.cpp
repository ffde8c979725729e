#include "viewer/gl/mesh_renderer.h"

#include <epoxy/gl.h>

#include <glm/gtc/type_ptr.hpp>
#include <string>
#include <utility>

#include "viewer/gl/mesh_attributes.h"

namespace meshfront {

struct MeshRenderer::Pass {
  const DrawStyle& style;
  const FrameState& frame;
  Projection projection;
  PixelSize size{};
  bool items = false;
};

namespace {

static_assert(kRestBytes == 36, "the wireframe's shader counts on it");

void prepare(const RenderTarget& target, bool withColour) {
  const std::array<GLenum, 2> attachments = {
      static_cast<GLenum>(withColour ? GL_COLOR_ATTACHMENT0 : GL_NONE), GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(target.framebuffer(), 2, attachments.data());
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
  glViewport(0, 0, target.size().width, target.size().height);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_MULTISAMPLE);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  const GLfloat background = 0;
  const std::array<GLuint, 4> noItem = {};
  glClearNamedFramebufferfv(target.framebuffer(), GL_DEPTH, 0, &background);
  glClearNamedFramebufferuiv(target.framebuffer(), GL_COLOR, 1, noItem.data());
}

Projection projectionFor(const RenderTarget& target, const Camera& camera, const Bounds& bounds,
                         const FrameState& frame) {
  return Projection::fit(camera, bounds, frame.aspect > 0 ? frame.aspect : target.size().aspect());
}

// Features that this mesh needs in this pass.
unsigned featuresFor(const GpuMesh& mesh, const DrawStyle& style, const FrameState& frame,
                     bool items) {
  unsigned features = items ? MeshPrograms::kItems : 0;
  if (style.slideSeconds > 0 && frame.now < mesh.lastBirth() + double{style.slideSeconds})
    features |= MeshPrograms::kSlides;
  if (style.colours && mesh.isTranslucent()) features |= MeshPrograms::kScreenDoor;
  if (items) return features;
  if (style.colouring != Colouring::surface) features |= MeshPrograms::kScale;
  if (style.wireframe && mesh.fitsShaderStorage()) features |= MeshPrograms::kWireframe;
  return features;
}

// The counts as a vertex attribute; 0 for all without any.
void attachPixels(const GpuMesh& mesh, GlName buffer) {
  const GLuint vao = mesh.vertexArray();
  if (buffer != 0) {
    glVertexArrayVertexBuffer(vao, kPixelBinding, buffer, 0, sizeof(uint32_t));
    glEnableVertexArrayAttrib(vao, kPixelAttribute);
  } else {
    glDisableVertexArrayAttrib(vao, kPixelAttribute);
    glVertexAttribI4ui(kPixelAttribute, 0, 0, 0, 0);
  }
}

}  // namespace

Result<MeshRenderer> MeshRenderer::create() {
  auto programs = MeshPrograms::create();
  if (!programs) return tl::unexpected(programs.error());
  return MeshRenderer(std::move(*programs));
}

void MeshRenderer::drawOne(const MeshInstance& instance, size_t number, uint32_t firstItem,
                           const Pass& pass) const {
  const GpuMesh& mesh = *instance.mesh;
  const InstanceView place = InstanceView::of(instance, pass.projection);
  if (!place.mayBeSeen(mesh.quantization())) return;
  const DrawStyle& style = pass.style;
  const unsigned features = featuresFor(mesh, style, pass.frame, pass.items);
  const MeshProgram& program = programs_->with(features);
  const GLuint name = program.program.name();
  const auto setMatrix = [name](GLint location, const glm::dmat4& matrix) {
    const glm::mat4 rounded(matrix);
    glProgramUniformMatrix4fv(name, location, 1, GL_FALSE, glm::value_ptr(rounded));
  };
  glUseProgram(name);
  glProgramUniform3i(name, program.anchor, place.anchor[0], place.anchor[1], place.anchor[2]);
  setMatrix(program.clipFromGrid, place.clipFromGrid);
  setMatrix(program.viewFromGrid, place.viewFromGrid);
  const glm::mat3 normals(place.viewFromNormal);
  glProgramUniformMatrix3fv(name, program.viewFromNormal, 1, GL_FALSE, glm::value_ptr(normals));
  glProgramUniform1f(name, program.slideNow, static_cast<float>(pass.frame.now - mesh.epoch()));
  glProgramUniform1f(name, program.slideSeconds, style.slideSeconds);
  glProgramUniform1i(name, program.scale, static_cast<GLint>(style.colouring));
  glProgramUniform1ui(name, program.finestLevel, style.finestLevel);
  glProgramUniform1ui(name, program.instance, static_cast<GLuint>(number));
  glProgramUniform1i(name, program.flatShading, style.flatShading ? 1 : 0);
  glProgramUniform1i(name, program.colours, style.colours && mesh.hasColours() ? 1 : 0);
  glProgramUniform1ui(name, program.firstItem, firstItem);
  glProgramUniform2f(name, program.halfPicture, 0.5F * static_cast<float>(pass.size.width),
                     0.5F * static_cast<float>(pass.size.height));
  if ((features & MeshPrograms::kWireframe) != 0) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, mesh.cornerBuffer());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, mesh.positionBuffer());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, mesh.restBuffer());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, mesh.birthBuffer());
  }
  if ((features & MeshPrograms::kScale) != 0) {
    const bool shown = style.colouring == Colouring::pixels && pass.frame.pixels != nullptr;
    attachPixels(mesh, shown ? pass.frame.pixels->buffer(number, mesh.vertexCount()) : 0);
  }
  glBindVertexArray(mesh.vertexArray());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangleCount()), GL_UNSIGNED_INT,
                 nullptr);
  glBindVertexArray(0);
}

void MeshRenderer::drawAll(const RenderTarget& target, std::span<const MeshInstance> instances,
                           const Pass& pass) const {
  prepare(target, !pass.items);
  uint64_t firstItem = 1;
  for (size_t i = 0; i < instances.size(); ++i) {
    const GpuMesh& mesh = *instances[i].mesh;
    if (firstItem + mesh.triangleCount() > UINT32_MAX) return;
    if (mesh.triangleCount() > 0 && mesh.vertexCount() > 0)
      drawOne(instances[i], i, static_cast<uint32_t>(firstItem), pass);
    firstItem += mesh.triangleCount();
  }
}

void MeshRenderer::draw(RenderTarget& target, std::span<const MeshInstance> instances,
                        const Camera& camera, const Bounds& bounds, const DrawStyle& style,
                        const FrameState& frame) const {
  const std::array<GLfloat, 4> background = {style.background[0], style.background[1],
                                             style.background[2], 1};
  const GLenum colours = GL_COLOR_ATTACHMENT0;
  glNamedFramebufferDrawBuffers(target.framebuffer(), 1, &colours);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_SCISSOR_TEST);
  glClearNamedFramebufferfv(target.framebuffer(), GL_COLOR, 0, background.data());
  drawAll(target, instances,
          {style, frame, projectionFor(target, camera, bounds, frame), target.size(), false});
}

void MeshRenderer::drawItems(RenderTarget& target, std::span<const MeshInstance> instances,
                             const Camera& camera, const Bounds& bounds, const DrawStyle& style,
                             const FrameState& frame) const {
  drawAll(target, instances,
          {style, frame, projectionFor(target, camera, bounds, frame), target.size(), true});
}

}  // namespace meshfront
