// What pictures cost: streams meshes in this process in every way there is, draws what each has
// brought, and compares with the full mesh.
//
//   evaluate-quality --output out --mesh bunny=bunny.pack --mesh igea=igea.pack
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "tests/evaluation/quality/experiments.h"
#include "viewer/gl/gl_context.h"

namespace meshfront::evaluation {
namespace {

struct QualityCommand {
  QualityOptions options;
  std::vector<std::string> meshes;  // NAME=PACK
  std::vector<std::string> views = {"whole", "half", "close"};
  std::vector<std::string> experiments = {"ways", "orders"};
};

Result<void> evaluateQuality(const QualityCommand& command) {
  auto context = GlContext::createHeadless();
  if (!context) return tl::unexpected(context.error());
  std::printf("%s\n", context->description().c_str());
  auto easel = Easel::create(command.options.size, PixelCounter::preferred(*context));
  if (!easel) return tl::unexpected(easel.error());
  std::vector<std::unique_ptr<EvaluatedMesh>> meshes;
  for (const std::string& text : command.meshes) {
    const size_t equals = text.find('=');
    if (command.options.isShort && !meshes.empty()) break;
    auto mesh =
        EvaluatedMesh::load(text.substr(0, equals), text.substr(equals + 1), command.views, *easel);
    if (!mesh) return tl::unexpected(mesh.error());
    meshes.push_back(std::move(*mesh));
  }
  for (const std::string& experiment : command.experiments) {
    Result<void> done = experiment == "ways" ? compareWays(meshes, *easel, command.options)
                                             : compareOrders(meshes, *easel, command.options);
    if (!done) return done;
  }
  const std::string errors = takeGlErrors();
  return errors.empty() ? Result<void>() : fail(errors);
}

}  // namespace
}  // namespace meshfront::evaluation

int main(int argc, char** argv) {
  using meshfront::evaluation::QualityCommand;
  try {
    CLI::App app(
        "Streams meshes in every way in this process and measures the pictures: experiments 3 "
        "(PSNR against bytes), 4 (only what is seen) and 5 (orders)");
    QualityCommand command;
    app.add_option("--output", command.options.output, "Folder for CSV, JSON and pictures")
        ->required();
    app.add_option("--mesh", command.meshes, "NAME=PACK; may be given several times")
        ->required()
        ->check(CLI::Validator(
            [](std::string& text) {
              const size_t equals = text.find('=');
              return equals == std::string::npos || equals == 0 ? "expected NAME=PACK"
                                                                : std::string();
            },
            "NAME=PACK"));
    app.add_flag("--short", command.options.isShort,
                 "The first mesh only, fewer views and a smaller exact order");
    app.add_option("--views", command.views, "Cameras, as meshfront-view's --camera")
        ->capture_default_str();
    app.add_option("--experiments", command.experiments, "ways, orders")
        ->capture_default_str()
        ->check(CLI::IsMember({"ways", "orders"}));
    app.add_option("--stop-at", command.options.stopAt, "Where curves end, dB")
        ->capture_default_str()
        ->check(CLI::Range(20.0, 98.0));
    app.add_option("--factor", command.options.factor,
                   "Of the bytes between two pictures of a curve")
        ->capture_default_str()
        ->check(CLI::Range(1.001, 4.0));
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    const auto done = meshfront::evaluation::evaluateQuality(command);
    if (!done) std::fprintf(stderr, "evaluate-quality: %s\n", done.error().message.c_str());
    return done ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate-quality: %s\n", error.what());
    return 1;
  }
}
