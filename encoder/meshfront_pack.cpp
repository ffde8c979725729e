// meshfront-pack: what is in a pack, proof that it is right, and its files for a static host.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "encoder/pack_tool/commands.h"

int main(int argc, char** argv) {
  using namespace meshfront;
  CLI::App app{"Looks into packs: info, verify, compare, dump, export."};
  app.require_subcommand(1);
  bool json = false;
  bool force = false;
  std::string a;
  std::string b;
  unsigned orders = 12;
  unsigned bits = kDefaultQuantizationBits;
  unsigned normalBits = kDefaultNormalBits;

  auto* info = app.add_subcommand(
      "info", "Counts, bounds, bits by field, depths, chunks and the encoder's report");
  info->add_option("PACK", a, "Pack")->required();
  auto* verify = app.add_subcommand(
      "verify", "Decodes in many orders and checks every front and the full mesh exactly");
  verify->add_option("PACK", a, "Pack")->required();
  verify->add_option("--against", b, "Mesh file the pack was encoded from")->required();
  verify->add_option("--orders", orders, "Orders to try")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  auto* compare = app.add_subcommand(
      "compare",
      "Are A (a mesh file, cleaned as the encoder does, or a .pack) and B (a mesh file as it is, "
      "or a .pack) the same triangles on the same quantised positions, with the same colours and "
      "normals?");
  compare->add_option("A", a, "Mesh file or pack")->required();
  compare->add_option("B", b, "Mesh file or pack")->required();
  compare->add_option("--quantization", bits, "Bits of A's grid, unless one is a pack")
      ->check(CLI::Range(kMinQuantizationBits, kMaxQuantizationBits))
      ->capture_default_str();
  compare
      ->add_option("--normal-bits", normalBits,
                   "Bits of a normal's coordinate, unless one is a pack")
      ->check(CLI::Range(kMinNormalBits, kMaxNormalBits))
      ->capture_default_str();
  auto* dump = app.add_subcommand("dump", "One node's record, decoded field by field");
  dump->add_option("PACK", a, "Pack")->required();
  dump->add_option("NODE", b,
                   "TREE:PATH, the path in steps from the root, 0 = left, 1 = right: 17:0110; a "
                   "root is 17:")
      ->required();
  auto* files = app.add_subcommand(
      "export",
      "Writes the static files of the interface (catalogue, metadata, base, chunks), so that any "
      "host of files serves the mesh by chunks");
  files->add_option("PACK", a, "Pack")->required();
  files
      ->add_option("DIR", b,
                   "Folder to write, whole or not at all; one of an earlier export is replaced")
      ->required();
  files->add_flag("--force", force,
                  "Replace DIR even if it is no export: what it holds now is deleted");
  for (auto* command : {info, verify, compare, dump})
    command->add_flag("--json", json, "Print JSON");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    Result<int> done = *info      ? printInfo(a, json)
                       : *verify  ? verifyAgainst(a, b, orders, json)
                       : *compare ? compareFiles(a, b, bits, normalBits, json)
                       : *dump    ? dumpNode(a, b, json)
                                  : exportFiles(a, b, force);
    if (done) return *done;
    fmt::print(stderr, "meshfront-pack: {}\n", done.error().message);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "meshfront-pack: out of memory\n");
  } catch (const std::exception& error) {  // standard output is closed, a folder unreadable
    fmt::print(stderr, "meshfront-pack: {}\n", error.what());
  }
  return 1;
}
