// write-synthetic-pack FILE NAME SEED ROOTS DEPTH [RECORDS_A_CHUNK]: a pack for tests of programs
// that serve packs.
#include <cstdio>
#include <cstdlib>

#include "tests/data/synthetic_mesh.h"

int main(int argc, char** argv) {
  if (argc != 6 && argc != 7) {
    std::fprintf(stderr,
                 "usage: write-synthetic-pack FILE NAME SEED ROOTS DEPTH [RECORDS_A_CHUNK]\n");
    return 2;
  }
  const auto number = [&](int i) { return static_cast<uint32_t>(std::atol(argv[i])); };
  meshfront::SyntheticOptions options{
      .name = argv[2], .seed = number(3), .roots = number(4), .maxDepth = number(5)};
  if (argc == 7) options.recordsPerChunk = number(6);
  const meshfront::SyntheticMesh mesh = meshfront::makeSyntheticMesh(options);
  const auto written = meshfront::writePack(argv[1], mesh.content);
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().message.c_str());
    return 1;
  }
  std::printf("%s %s: %zu records, %u chunks\n", written->name.c_str(), written->revision.c_str(),
              mesh.entries.size(), written->chunkCount);
  return 0;
}
