#include "tests/evaluation/quality/whole_download.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "shared/mesh/grid_mesh.h"

extern char** environ;

namespace meshfront::evaluation {
namespace {

constexpr int kProgramNotFound = 127;

// Exit status, or kProgramNotFound; what it prints is dropped.
int runQuietly(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return kProgramNotFound;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

class OwnFolder {
 public:
  OwnFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "meshfront-draco-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~OwnFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

Result<std::optional<uint64_t>> dracoBytes(const RefinedPack& full) {
  const OwnFolder folder;
  if (folder.path().empty()) return fail(ErrorCode::unavailable, "cannot make a temporary folder");
  const GridMesh mesh = full.mesh().snapshot();
  const std::filesystem::path input = folder.path() / "mesh.obj";
  const std::filesystem::path output = folder.path() / "mesh.drc";
  std::ofstream out(input);
  for (const GridPosition& p : mesh.positions)
    out << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const Triangle& t : mesh.triangles)
    out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  out.close();
  if (out.fail()) return fail(ErrorCode::unavailable, "cannot write " + input.string());
  const std::string bits = std::to_string(full.pack().metadata().quantization.bits);
  const int status = runQuietly(
      {"draco_encoder", "-i", input.string(), "-o", output.string(), "-qp", bits, "-cl", "10"});
  if (status == kProgramNotFound) return std::optional<uint64_t>();
  std::error_code error;
  const uintmax_t bytes = std::filesystem::file_size(output, error);
  if (status != 0 || error) return fail("draco_encoder failed on " + full.pack().metadata().name);
  return std::optional<uint64_t>(bytes);
}

}  // namespace meshfront::evaluation
