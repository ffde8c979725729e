#include "viewer/view_options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>
#include <utility>
#include <vector>

namespace meshfront {
namespace {

constexpr int kMaxSide = 16'384;
constexpr double kSmallestInterface = 0.5;
constexpr double kLargestInterface = 4;

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

// One of a few words; the message lists them.
template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;
template <typename Value>
CLI::Validator chosenFrom(const Choices<Value>& choices, Value& target) {
  return {[choices, &target](std::string& text) {
            std::string expected;
            for (const auto& [word, value] : choices) {
              if (word == text) {
                target = value;
                return std::string();
              }
              expected += (expected.empty() ? "" : " or ") + word;
            }
            return "expected " + expected + ", not '" + text + "'";
          },
          ""};
}

constexpr std::string_view kPathHelp =
    "{\"frames_per_second\": 30, \"interpolation\": \"smooth\" (or \"linear\"),\n"
    " \"loop\": false (true: the last key frame has the first one's camera),\n"
    " \"rounds\": 1 (of a loop),\n"
    " \"key_frames\": [{\"time\": 0, \"camera\": \"azimuth=0;elevation=20\"},\n"
    "                {\"time\": 2, \"eye\": [0, 1, 5], \"target\": [0, 0, 0],\n"
    "                 \"up\": [0, 1, 0], \"fov\": 35}]}\n"
    "Times are seconds; azimuths are taken as written: 0 to 360 is a whole turn.";

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

Result<double> parseInterfaceScale(const std::string& text) {
  double scale = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), scale);
  const bool number = code == std::errc() && end == text.data() + text.size();
  if (!number || !(scale == 0 || (scale >= kSmallestInterface && scale <= kLargestInterface)))
    return fail("expected 0 (the display's) or 0.5 to 4, not '" + text + "'");
  return scale;
}

// What was written; the values are parsed.
struct OctetTexts {
  std::string memory;
  std::string cache;
};

// A mesh's URL, or the path of a file that names several.
Result<std::vector<SceneMesh>> readScene(const std::string& text) {
  if (text.find("://") == std::string::npos && text.ends_with(".json")) return readSceneFile(text);
  auto url = parseMeshUrl(text);
  if (!url) return fail(url.error().code, url.error().message + " (or the name of a .json file)");
  return sceneOf(text, std::move(*url));
}

// Octets: 500000, 64MiB, 2GB.
Result<uint64_t> parseOctets(std::string_view text) {
  const auto amount = parseStopCondition(text);
  if (!amount || amount->kind != StopCondition::Kind::bytes || amount->amount == 0)
    return fail("expected a number of bytes, such as 500000, 512MiB or 2GB");
  return amount->amount;
}

void addRefinementOptions(CLI::App& app, ViewOptions& options, OctetTexts& texts) {
  app.add_flag("!--no-rim", options.rim,
               "do not split what covers no pixel but has an edge to something seen: fewer "
               "bytes, and a few pixels along silhouettes that are not the published mesh's");
  app.add_option("--triangle-budget", options.triangleBudget,
                 "most triangles drawn at a time; what the view does not need is collapsed and "
                 "split again from what is kept; 0: no limit")
      ->capture_default_str();
  app.add_option("--memory-budget", texts.memory,
                 "most memory for meshes, here and on the GPU together: 512MiB, 4GB; what has not "
                 "been needed for longest is forgotten (default: no limit)")
      ->check(parsedBy(parseOctets, options.memoryBudget, "BYTES"));
  app.add_option("--cache-dir", options.cacheDir,
                 "folder that keeps what was received: a later viewer goes on from there, without "
                 "a service too");
  app.add_option("--cache-budget", texts.cache,
                 "most bytes in --cache-dir, of all meshes (default 1GiB)")
      ->check(parsedBy(parseOctets, options.cacheBudget, "BYTES"));
}

void addPathOptions(CLI::App& app, ViewOptions& options, std::string& pathFile,
                    std::string& paceText) {
  app.add_option("--path", pathFile, "headless: play a camera path, JSON key frames, see below")
      ->check(parsedBy(readCameraPath, options.path, "FILE"));
  app.add_option("--path-pace", paceText,
                 "of --path: real (a frame gets the answers of its share of a second; default) or "
                 "settled (each frame waits for all that it shows)")
      ->check(chosenFrom<FlightPace>({{"real", FlightPace::real}, {"settled", FlightPace::settled}},
                                     options.pace));
  app.add_option("--frames", options.frames, "of --path: write frame-00000.png ... to this folder");
  app.add_option("--path-log", options.pathLog,
                 "of --path: CSV of each frame's time, bytes, splits, triangles, PSNR and state");
}

void addWindowOptions(CLI::App& app, ViewOptions& options) {
  app.add_flag("--complete", options.complete,
               "window: when all that is seen is there, fetch the rest");
  app.add_flag("!--no-foveation", options.foveation,
               "window: do not prefer the middle of the picture");
  app.add_flag("!--no-prefetch", options.prefetch,
               "window: do not fetch ahead for the view that a movement leads to");
  app.add_flag("!--no-geomorph", options.geomorph,
               "window: new vertices appear at their places instead of sliding there (key G)");
  app.add_option("--item-divisor", options.itemDivisor,
                 "window: rank at 1/1, 1/2 or 1/4 of the picture's resolution")
      ->check(CLI::IsMember({1, 2, 4}).description("{1,2,4}"))
      ->capture_default_str();
  app.add_option("--script", options.scriptFile,
                 "play a script in the window, see below; it may run commands")
      ->check(parsedBy(readScript, options.script, "FILE"));
  app.add_option("--interface-scale", options.interfaceScale,
                 "size of the window's letters, 0.5 to 4; 0: the display's")
      ->check(parsedBy(parseInterfaceScale, options.interfaceScale, ""))
      ->capture_default_str();
}

// Combinations that parse but cannot work; empty = fine.
std::string contradiction(const ViewOptions& options) {
  const bool needsReference =
      options.until.kind == StopCondition::Kind::psnr || options.psnrTarget.has_value();
  if (needsReference && !options.reference)
    return "--psnr-target and --until psnr:DB need a --reference mesh";
  const bool limited = options.until.kind == StopCondition::Kind::bytes ||
                       options.until.kind == StopCondition::Kind::records;
  if (options.scene.size() > 1 && (options.reference || limited))
    return "--reference and --until records or bytes are of a single mesh, not of a scene";
  if (options.headless && options.complete)
    return "--complete is for the window: with --headless it is --until complete";
  if (options.path && !options.headless)
    return "--path plays without a window: add --headless; a window's camera is moved by --script";
  if (!options.path && (options.frames || options.pathLog || options.paceGiven))
    return "--frames, --path-log and --path-pace say how a --path is played, and there is none";
  if (options.path && (options.untilGiven || options.psnrTarget || options.screenshot ||
                       options.exportPly || options.trace))
    return "--until, --psnr-target, --screenshot, --export and --trace are of a single view: leave "
           "them out with --path (it writes --frames and --path-log)";
  if (options.path && options.cameraGiven)
    return "--path says where the camera is: leave out --camera";
  if (options.headless && (!options.scriptFile.empty() || options.interfaceScale > 0))
    return "--script and --interface-scale are for the window: leave out --headless";
  if (!options.headless &&
      (options.untilGiven || options.reference || options.timeout > 0 || options.live))
    return "--until, --reference, --psnr-target, --timeout and --live need --headless";
  return {};
}

}  // namespace

ParsedOptions parseViewOptions(int argc, char** argv) {
  ParsedOptions parsed;
  ViewOptions& options = parsed.options;
  CLI::App app("Shows a mesh that a meshfront service streams, best parts first.");
  app.set_version_flag("--version", "meshfront-view 0.1.0");
  app.footer(
      "--camera SPEC:\n" + std::string(kCameraSpecHelp) + "\n--path FILE:\n" +
      std::string(kPathHelp) + "\n--script FILE:\n" + std::string(kScriptHelp) +
      "\nA scene: {\"meshes\": [{\"url\": \"http://HOST/v1/meshes/NAME\", \"translate\": [x, y, z],"
      "\n  \"rotate\": {\"axis\": [x, y, z], \"degrees\": d}, \"scale\": s}, ...]}; or "
      "\"matrix\", 16 numbers"
      "\nExit codes: 0 done, 1 failed, 2 wrong usage.");

  std::string sizeText;
  std::string cameraText;
  std::string untilText;
  std::string pathFile;
  OctetTexts octets;
  std::string paceText;
  std::string fetchText;
  std::string rankText;
  app.add_option("url", options.urlText,
                 "http://HOST:PORT/v1/meshes/NAME, or a scene of several meshes: a JSON file, see "
                 "below")
      ->required()
      ->check(parsedBy(readScene, options.scene, "URL|FILE"));
  app.add_flag("--headless", options.headless, "draw without a window or a display");
  app.add_option("--size", sizeText, "picture in pixels, WIDTHxHEIGHT (default 1280x720)")
      ->check(parsedBy(parseSize, options.size, ""));
  app.add_option("--camera", cameraText, "where from, see below")
      ->check(parsedBy(parseCameraSpec, options.camera, ""));
  app.add_option("--fetch", fetchText,
                 "exact (the records that the view wants; default) or chunks (constant pieces that "
                 "any HTTP cache answers)")
      ->check(chosenFrom<FetchMode>({{"exact", FetchMode::exact}, {"chunks", FetchMode::chunks}},
                                    options.mode));
  app.add_option(
         "--rank", rankText,
         "what to ask for first: significance (level and what is likely wrong; default) or pixels")
      ->check(chosenFrom<RankOrder>(
          {{"significance", RankOrder::significance}, {"pixels", RankOrder::pixels}},
          options.order));
  auto* until = app.add_option("--until", untilText,
                               "headless: stop when settled (default: all that is seen is there), "
                               "complete, or after bytes down (20000, 20kB, 64KiB), records:N, "
                               "psnr:DB")
                    ->check(parsedBy(parseStopCondition, options.until, ""));
  app.add_option("--batch", options.batch, "exact: records a request; 0: 200 to 2000 by mesh size")
      ->check(CLI::Range(0U, 100'000U).description(""))
      ->capture_default_str();
  app.add_option(
         "--window", options.window,
         "requests under way at a time, 1 to 16; 0: as many as keep the link busy in a window, "
         "else 1 for exact sets, 4 for chunks")
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
  app.add_flag("--live", options.live,
               "headless: ask as a window does, for as much as the link holds and for descendants "
               "by need; what is asked for then depends on time");
  app.add_option("--timeout", options.timeout, "headless: seconds until giving up; 0: never")
      ->check(CLI::NonNegativeNumber.description(""))
      ->capture_default_str();
  addRefinementOptions(app, options, octets);
  addPathOptions(app, options, pathFile, paceText);
  addWindowOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exitCode = app.exit(error) == 0 ? 0 : 2;
    return parsed;
  }
  options.untilGiven = until->count() > 0;
  options.paceGiven = app.count("--path-pace") > 0;
  options.cameraGiven = app.count("--camera") > 0;
  if (const std::string problem = contradiction(options); !problem.empty()) {
    std::cerr << "meshfront-view: " << problem << '\n';
    parsed.exitCode = 2;
  }
  return parsed;
}

}  // namespace meshfront
