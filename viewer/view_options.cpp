#include "viewer/view_options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>
#include <map>

namespace meshfront {
namespace {

constexpr int kMaxSide = 16'384;

Result<PixelSize> parseSize(std::string_view text) {
  PixelSize size;
  const size_t by = text.find('x');
  const auto side = [](std::string_view digits, int& value) {
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return code == std::errc() && end == digits.data() + digits.size() && value >= 1 &&
           value <= kMaxSide;
  };
  if (by == std::string_view::npos || !side(text.substr(0, by), size.width) ||
      !side(text.substr(by + 1), size.height))
    return fail("expected WIDTHxHEIGHT with sides of 1 to " + std::to_string(kMaxSide) +
                " pixels, such as 500x500");
  return size;
}

// A CLI11 check that keeps the parsed value; messages come from the parser.
template <typename Value, typename Parser>
CLI::Validator parsedBy(Parser parser, Value& target, const std::string& kind) {
  return {[parser, &target](std::string& text) {
            auto value = parser(text);
            if (!value) return value.error().message;
            target = std::move(*value);
            return std::string();
          },
          kind};
}

// Combinations that parse but cannot work; empty = fine.
std::string contradiction(const ViewOptions& options) {
  const bool needsReference =
      options.until.kind == StopCondition::Kind::psnr || options.psnrTarget.has_value();
  if (needsReference && !options.reference)
    return "--psnr-target and --until psnr:DB need a --reference mesh";
  if (!options.headless && (options.untilGiven || options.reference || options.timeout > 0))
    return "--until, --reference, --psnr-target and --timeout need --headless";
  return {};
}

}  // namespace

ParsedOptions parseViewOptions(int argc, char** argv) {
  ParsedOptions parsed;
  ViewOptions& options = parsed.options;
  CLI::App app("Shows a mesh that a meshfront service streams, best parts first.");
  app.set_version_flag("--version", "meshfront-view 0.1.0");
  app.footer("--camera SPEC:\n" + std::string(kCameraSpecHelp) +
             "\nExit codes: 0 done, 1 failed, 2 wrong usage.");

  std::string sizeText;
  std::string cameraText;
  std::string untilText;
  app.add_option("url", options.urlText, "http://HOST:PORT/v1/meshes/NAME")
      ->required()
      ->check(parsedBy(parseMeshUrl, options.url, "URL"));
  app.add_flag("--headless", options.headless, "draw without a window or a display");
  app.add_option("--size", sizeText, "picture in pixels, WIDTHxHEIGHT (default 1280x720)")
      ->check(parsedBy(parseSize, options.size, ""));
  app.add_option("--camera", cameraText, "where from, see below")
      ->check(parsedBy(parseCameraSpec, options.camera, ""));
  const std::map<std::string, RankOrder> orders{{"significance", RankOrder::significance},
                                                {"pixels", RankOrder::pixels}};
  const std::map<std::string, FetchMode> modes{{"exact", FetchMode::exact},
                                               {"chunks", FetchMode::chunks}};
  app.add_option("--fetch", options.mode,
                 "exact (the records that the view wants; default) or chunks (constant pieces that "
                 "any HTTP cache answers)")
      ->transform(CLI::CheckedTransformer(modes).description(""));
  app.add_option("--rank", options.order,
                 "what to ask for first: significance (level, then pixels; default) or pixels")
      ->transform(CLI::CheckedTransformer(orders).description(""));
  auto* until = app.add_option("--until", untilText,
                               "headless: stop when settled (default: all that is seen is there), "
                               "complete, or after bytes down (20000, 20kB, 64KiB), records:N, "
                               "psnr:DB")
                    ->check(parsedBy(parseStopCondition, options.until, ""));
  app.add_option("--batch", options.batch, "exact: records a request; 0: 200 to 2000 by mesh size")
      ->check(CLI::Range(0U, 100'000U).description(""))
      ->capture_default_str();
  app.add_option("--window", options.window,
                 "requests under way at a time, 1 to 16; 0: 2 for exact sets, 4 for chunks")
      ->check(CLI::Range(0U, 16U).description(""))
      ->capture_default_str();
  app.add_option("--screenshot", options.screenshot, "write the final picture as PNG");
  app.add_option("--export", options.exportPly, "write the final mesh as PLY");
  app.add_option("--trace", options.trace, "write costs and gains of each answer as CSV");
  app.add_option("--reference", options.reference,
                 "headless: mesh file to draw likewise; prints the PSNR of the picture")
      ->check(CLI::ExistingFile.description(""));
  app.add_option("--psnr-target", options.psnrTarget,
                 "dB; prints what it took to get there (checked after each answer)")
      ->check(CLI::Range(0.0, 100.0).description(""));
  app.add_flag("--json", options.json, "print the summary as JSON");
  app.add_flag("!--no-colours", options.colours, "draw clay even where the mesh has colours");
  app.add_flag("--count-on-cpu", options.countOnCpu,
               "count pixels on the CPU: the reference way, with equal results");
  app.add_option("--timeout", options.timeout, "headless: seconds until giving up; 0: never")
      ->check(CLI::NonNegativeNumber.description(""))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exitCode = app.exit(error) == 0 ? 0 : 2;
    return parsed;
  }
  options.untilGiven = until->count() > 0;
  if (const std::string problem = contradiction(options); !problem.empty()) {
    std::cerr << "meshfront-view: " << problem << '\n';
    parsed.exitCode = 2;
  }
  return parsed;
}

}  // namespace meshfront
