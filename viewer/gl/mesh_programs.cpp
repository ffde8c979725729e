#include "viewer/gl/mesh_programs.h"

#include <epoxy/gl.h>

#include <utility>

#include "viewer/gl/colour_scales.h"
#include "viewer/gl/mesh_shaders.h"
#include "viewer/gl/shader_program.h"

namespace meshfront {
namespace {

Result<GlProgram> build(unsigned features) {
  std::string head = "#version 450 core\n";
  for (const auto& [feature, define] :
       {std::pair(MeshPrograms::kSlides, "SLIDES"), std::pair(MeshPrograms::kScale, "SCALE"),
        std::pair(MeshPrograms::kScreenDoor, "SCREEN_DOOR"),
        std::pair(MeshPrograms::kWireframe, "WIREFRAME")}) {
    if ((features & feature) != 0) head += std::string("#define ") + define + "\n";
  }
  const bool items = (features & MeshPrograms::kItems) != 0;
  std::string vertex = head + kPlaceShader + kVertexPlaceShader;
  if ((features & MeshPrograms::kScale) != 0) vertex += kColourScaleShader;
  vertex += items ? kItemVertexShader : kMeshVertexShader;
  std::string fragment = head;
  if ((features & MeshPrograms::kWireframe) != 0) fragment += kPlaceShader;
  if ((features & MeshPrograms::kScreenDoor) != 0) fragment += kScreenDoorShader;
  fragment += items ? kItemFragmentShader : kMeshFragmentShader;
  return drawProgram((items ? "items " : "mesh ") + std::to_string(features), vertex, fragment);
}

}  // namespace

MeshProgram::MeshProgram(GlProgram linked) : program(std::move(linked)) {
  const auto at = [this](const char* name) { return glGetUniformLocation(program.name(), name); };
  anchor = at("anchor");
  clipFromGrid = at("clipFromGrid");
  viewFromGrid = at("viewFromGrid");
  viewFromNormal = at("viewFromNormal");
  slideNow = at("slideNow");
  slideSeconds = at("slideSeconds");
  scale = at("scale");
  finestLevel = at("finestLevel");
  instance = at("instance");
  flatShading = at("flatShading");
  colours = at("colours");
  firstItem = at("firstItem");
  halfPicture = at("halfPicture");
}

Result<MeshPrograms> MeshPrograms::create() {
  MeshPrograms programs;
  for (const unsigned features : {0U, kItems}) {
    Result<GlProgram> built = build(features);
    if (!built) return tl::unexpected(built.error());
    programs.programs_.try_emplace(features, std::move(*built));
  }
  return programs;
}

const MeshProgram& MeshPrograms::with(unsigned features) {
  if (const auto found = programs_.find(features); found != programs_.end()) return found->second;
  Result<GlProgram> built = build(features);
  if (built) return programs_.try_emplace(features, std::move(*built)).first->second;
  problem_ = built.error().message;
  return programs_.at(features & kItems);
}

}  // namespace meshfront
