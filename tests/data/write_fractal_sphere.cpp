// write-fractal-sphere: a mesh of any size for tests and figures, as binary PLY.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "tests/data/fractal_sphere.h"

int main(int argc, char** argv) {
  CLI::App app{"Writes a sphere with fractal mountains and scanner noise as binary PLY."};
  uint64_t vertices = 1000000;
  uint64_t seed = 1;
  double noise = 0.15;
  std::string output;
  app.add_option("--vertices", vertices, "Vertices, at least; the next 10 f^2 + 2 is taken")
      ->check(CLI::Range(uint64_t{12}, uint64_t{1} << 31))
      ->capture_default_str();
  app.add_option("--seed", seed, "Of the noise")->capture_default_str();
  app.add_option("--scanner-noise", noise, "Largest white noise, in edge lengths")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--output", output, "PLY to write")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const meshfront::FractalSphere sphere(vertices, seed, noise);
  if (const auto written = meshfront::writeFractalSphere(output, sphere); !written) {
    std::fprintf(stderr, "write-fractal-sphere: %s\n", written.error().message.c_str());
    return 1;
  }
  std::printf("%s: %llu vertices, %llu triangles\n", output.c_str(),
              static_cast<unsigned long long>(sphere.vertexCount()),
              static_cast<unsigned long long>(sphere.triangleCount()));
  return 0;
}
