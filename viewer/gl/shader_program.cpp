#include "viewer/gl/shader_program.h"

#include <epoxy/gl.h>

#include <string>

namespace meshfront {
namespace {

Result<GlShader> compiled(std::string_view name, GLenum stage, std::string_view source) {
  GlShader shader(glCreateShader(stage));
  const GLchar* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  glShaderSource(shader.name(), 1, &text, &length);
  glCompileShader(shader.name());
  GLint ok = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei written = 0;
    glGetShaderInfoLog(shader.name(), static_cast<GLsizei>(log.size()), &written, log.data());
    log.resize(static_cast<size_t>(written));
    return fail("shader '" + std::string(name) + "' does not compile: " + log);
  }
  return shader;
}

Result<GlProgram> linked(std::string_view name, GlProgram program) {
  glLinkProgram(program.name());
  GLint ok = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei written = 0;
    glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), &written, log.data());
    log.resize(static_cast<size_t>(written));
    return fail("shader '" + std::string(name) + "' does not link: " + log);
  }
  return program;
}

}  // namespace

Result<GlProgram> drawProgram(std::string_view name, std::string_view vertexSource,
                              std::string_view fragmentSource) {
  auto vertex = compiled(name, GL_VERTEX_SHADER, vertexSource);
  if (!vertex) {
    return tl::unexpected(vertex.error());
  }
  auto fragment = compiled(name, GL_FRAGMENT_SHADER, fragmentSource);
  if (!fragment) {
    return tl::unexpected(fragment.error());
  }
  GlProgram program(glCreateProgram());
  glAttachShader(program.name(), vertex->name());
  glAttachShader(program.name(), fragment->name());
  return linked(name, std::move(program));
}

Result<GlProgram> computeProgram(std::string_view name, std::string_view source) {
  auto shader = compiled(name, GL_COMPUTE_SHADER, source);
  if (!shader) {
    return tl::unexpected(shader.error());
  }
  GlProgram program(glCreateProgram());
  glAttachShader(program.name(), shader->name());
  return linked(name, std::move(program));
}

}  // namespace meshfront
