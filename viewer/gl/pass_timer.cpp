#include "viewer/gl/pass_timer.h"

#include <epoxy/gl.h>

namespace meshfront {

void PassTimer::begin() {
  collect();
  running_ = onTheWay_ < kQueries;
  if (!running_) return;
  GlQuery& query = queries_.at((first_ + onTheWay_) % kQueries);
  if (query.name() == 0) {
    GLuint name = 0;
    glCreateQueries(GL_TIME_ELAPSED, 1, &name);
    query = GlQuery(name);
  }
  glBeginQuery(GL_TIME_ELAPSED, query.name());
}

void PassTimer::end() {
  if (!running_) return;
  glEndQuery(GL_TIME_ELAPSED);
  running_ = false;
  ++onTheWay_;
}

void PassTimer::collect() {
  while (onTheWay_ > 0) {
    const GLuint query = queries_.at(first_).name();
    GLint available = GL_FALSE;
    glGetQueryObjectiv(query, GL_QUERY_RESULT_AVAILABLE, &available);
    if (available == GL_FALSE) return;
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    latest_ = static_cast<double>(nanoseconds) * 1e-6;
    first_ = (first_ + 1) % kQueries;
    --onTheWay_;
  }
}

std::optional<double> PassTimer::milliseconds() {
  collect();
  return latest_;
}

}  // namespace meshfront
