// write-synthetic-pack FILE NAME SEED ROOTS DEPTH: a pack for tests of programs that serve packs.
#include <cstdio>
#include <cstdlib>

#include "tests/data/synthetic_mesh.h"

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: write-synthetic-pack FILE NAME SEED ROOTS DEPTH\n");
    return 2;
  }
  const auto number = [&](int i) { return static_cast<uint32_t>(std::atol(argv[i])); };
  const meshfront::SyntheticMesh mesh = meshfront::makeSyntheticMesh(
      {.name = argv[2], .seed = number(3), .roots = number(4), .maxDepth = number(5)});
  const auto written = meshfront::writePack(argv[1], mesh.content);
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().message.c_str());
    return 1;
  }
  std::printf("%s %s: %zu records, %u chunks\n", written->name.c_str(), written->revision.c_str(),
              mesh.entries.size(), written->chunkCount);
  return 0;
}
