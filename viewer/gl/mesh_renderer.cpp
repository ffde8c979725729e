#include "viewer/gl/mesh_renderer.h"

#include <epoxy/gl.h>

#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <string>
#include <utility>

#include "viewer/gl/mesh_shaders.h"
#include "viewer/gl/shader_program.h"

namespace meshfront {
namespace {

// The grid point nearest to the eye.
GridPosition anchorFor(const Quantization& quantization, const glm::dvec3& eye) {
  return quantization.toGrid({eye.x, eye.y, eye.z});
}

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

}  // namespace

MeshRenderer::Program::Program(GlProgram linked) : program(std::move(linked)) {
  anchor = glGetUniformLocation(program.name(), "anchor");
  clipFromGrid = glGetUniformLocation(program.name(), "clipFromGrid");
  viewFromGrid = glGetUniformLocation(program.name(), "viewFromGrid");
  flatShading = glGetUniformLocation(program.name(), "flatShading");
  colours = glGetUniformLocation(program.name(), "colours");
  halfPicture = glGetUniformLocation(program.name(), "halfPicture");
}

MeshRenderer::MeshRenderer(Program shaded, Program wireframe, Program items)
    : shaded_(std::move(shaded)), wireframe_(std::move(wireframe)), items_(std::move(items)) {}

Result<MeshRenderer> MeshRenderer::create() {
  const std::string version = "#version 450 core\n";
  auto shaded = drawProgram("mesh", kMeshVertexShader, version + kMeshFragmentShader);
  if (!shaded) {
    return tl::unexpected(shaded.error());
  }
  auto wireframe = drawProgram("mesh with edges", kMeshVertexShader,
                               version + "#define WIREFRAME\n" + kMeshFragmentShader);
  if (!wireframe) {
    return tl::unexpected(wireframe.error());
  }
  auto items = drawProgram("items", kItemVertexShader, kItemFragmentShader);
  if (!items) {
    return tl::unexpected(items.error());
  }
  return MeshRenderer(Program(std::move(*shaded)), Program(std::move(*wireframe)),
                      Program(std::move(*items)));
}

void MeshRenderer::drawWith(const Program& program, const RenderTarget& target, const GpuMesh& mesh,
                            const Projection& projection) {
  if (mesh.triangleCount() == 0 || mesh.vertexCount() == 0) {
    return;
  }
  const Quantization& quantization = mesh.quantization();
  const GridPosition anchor = anchorFor(quantization, projection.camera.eye);
  const std::array<double, 3> world = quantization.toWorld(anchor);
  const glm::dvec3 origin(world[0], world[1], world[2]);
  glm::dmat4 scale(quantization.step);
  scale[3][3] = 1;
  const glm::mat4 clip(projection.clipFrom(origin) * scale);
  const glm::mat4 view(projection.viewFrom(origin) * scale);
  const GLuint name = program.program.name();
  glUseProgram(name);
  glProgramUniform3i(name, program.anchor, anchor[0], anchor[1], anchor[2]);
  glProgramUniformMatrix4fv(name, program.clipFromGrid, 1, GL_FALSE, glm::value_ptr(clip));
  if (program.viewFromGrid >= 0) {
    glProgramUniformMatrix4fv(name, program.viewFromGrid, 1, GL_FALSE, glm::value_ptr(view));
  }
  if (program.halfPicture >= 0) {
    glProgramUniform2f(name, program.halfPicture, 0.5F * static_cast<float>(target.size().width),
                       0.5F * static_cast<float>(target.size().height));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, mesh.cornerBuffer());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, mesh.positionBuffer());
  }
  glBindVertexArray(mesh.vertexArray());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangleCount()), GL_UNSIGNED_INT,
                 nullptr);
  glBindVertexArray(0);
}

void MeshRenderer::draw(RenderTarget& target, const GpuMesh& mesh, const Camera& camera,
                        const Bounds& bounds, const DrawStyle& style) const {
  prepare(target, true);
  const std::array<GLfloat, 4> background = {style.background[0], style.background[1],
                                             style.background[2], 1};
  glClearNamedFramebufferfv(target.framebuffer(), GL_COLOR, 0, background.data());
  const Program& program = style.wireframe && mesh.fitsShaderStorage() ? wireframe_ : shaded_;
  glProgramUniform1i(program.program.name(), program.flatShading, style.flatShading ? 1 : 0);
  glProgramUniform1i(program.program.name(), program.colours,
                     style.colours && mesh.hasColours() ? 1 : 0);
  drawWith(program, target, mesh, Projection::fit(camera, bounds, target.size().aspect()));
}

void MeshRenderer::drawItems(RenderTarget& target, const GpuMesh& mesh, const Camera& camera,
                             const Bounds& bounds) const {
  prepare(target, false);
  drawWith(items_, target, mesh, Projection::fit(camera, bounds, target.size().aspect()));
}

}  // namespace meshfront
