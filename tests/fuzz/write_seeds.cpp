// write-fuzz-seeds DIR: writes the seeds of all targets, DIR/TARGET/NAME; others stay.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seeds.h"

int main(int argc, char** argv) {
  using namespace meshfront::fuzz;
  if (argc != 2) {
    std::fprintf(stderr, "usage: write-fuzz-seeds DIR\n");
    return 2;
  }
  size_t count = 0;
  for (const auto& seeds : {textMeshSeeds(), binaryMeshSeeds(), httpSeeds(), formatSeeds()})
    for (const Seed& seed : seeds) {
      const auto folder = std::filesystem::path(argv[1]) / seed.target;
      std::error_code error;
      std::filesystem::create_directories(folder, error);
      std::ofstream out(folder / seed.name, std::ios::binary);
      out.write(seed.content.data(), static_cast<std::streamsize>(seed.content.size()));
      if (!out.flush()) {
        std::fprintf(stderr, "write-fuzz-seeds: %s/%s cannot be written\n", folder.c_str(),
                     seed.name.c_str());
        return 1;
      }
      ++count;
    }
  std::printf("%zu seeds\n", count);
  return 0;
}
