#include "viewer/gl/gl_object.h"

#include <epoxy/gl.h>

namespace meshfront {

void deleteGlName(GlKind kind, GlName name) {
  switch (kind) {
    case GlKind::buffer:
      glDeleteBuffers(1, &name);
      break;
    case GlKind::texture:
      glDeleteTextures(1, &name);
      break;
    case GlKind::framebuffer:
      glDeleteFramebuffers(1, &name);
      break;
    case GlKind::vertexArray:
      glDeleteVertexArrays(1, &name);
      break;
    case GlKind::program:
      glDeleteProgram(name);
      break;
    case GlKind::shader:
      glDeleteShader(name);
      break;
    case GlKind::query:
      glDeleteQueries(1, &name);
      break;
  }
}

GlSync::~GlSync() {
  if (sync_ != nullptr) {
    glDeleteSync(sync_);
  }
}

}  // namespace meshfront
