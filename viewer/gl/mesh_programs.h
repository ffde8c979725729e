// The programs of MeshRenderer, by what they can do; each is built when it is first asked for.
#pragma once

#include <map>
#include <string>

#include "shared/result.h"
#include "viewer/gl/gl_object.h"

namespace meshfront {

struct MeshProgram {
  GlProgram program;
  // Locations of uniforms; -1 where the program has none.
  int anchor = -1;
  int clipFromGrid = -1;
  int viewFromGrid = -1;
  int viewFromNormal = -1;
  int slideNow = -1;
  int slideSeconds = -1;
  int scale = -1;
  int finestLevel = -1;
  int instance = -1;
  int flatShading = -1;
  int colours = -1;
  int firstItem = -1;
  int halfPicture = -1;
  explicit MeshProgram(GlProgram linked);
};

class MeshPrograms {
 public:
  // Features, to be or-ed.
  static constexpr unsigned kItems = 1;  // items and depth alone
  static constexpr unsigned kSlides = 2;
  static constexpr unsigned kScreenDoor = 4;
  static constexpr unsigned kScale = 8;       // not with kItems
  static constexpr unsigned kWireframe = 16;  // not with kItems

  // Builds the two plain ones.
  [[nodiscard]] static Result<MeshPrograms> create();
  // A driver that cannot build it gets the plain one.
  [[nodiscard]] const MeshProgram& with(unsigned features);
  // The compiler's message then; empty otherwise.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  MeshPrograms() = default;
  std::map<unsigned, MeshProgram> programs_;
  std::string problem_;
};

}  // namespace meshfront
