#include "encoder/pipeline/encode_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "encoder/pipeline/memory_estimate.h"
#include "encoder/pipeline/phase_clock.h"
#include "shared/codec/base_mesh.h"
#include "shared/mesh_files/mesh_files.h"

namespace meshfront {
namespace {

// Gives the memory back; assigning {} to a vector would keep it.
template <typename Container>
void release(Container& container) {
  Container().swap(container);
}

// An Error if the estimate is above the limit.
Result<void> fits(const MeshSize& size, uint64_t fileBytes, const EncodeOptions& options) {
  constexpr double kMebi = 1048576;
  const uint64_t needed = estimateMemory(size, fileBytes).peak();
  if (needed <= options.memoryLimit) return {};
  return fail(
      ErrorCode::tooLarge,
      fmt::format("encoding {} vertices and {} triangles needs about {:.0f} MiB of memory, "
                  "but {} leaves {:.0f} MiB; use a machine with more, cut the mesh into "
                  "parts, or allow more with --memory-limit if there is swap",
                  size.vertices, size.triangles, static_cast<double>(needed) / kMebi,
                  options.memoryLimitedBy, static_cast<double>(options.memoryLimit) / kMebi));
}

std::vector<uint64_t> leavesByDepth(const VertexForest& forest, size_t realVertices) {
  std::vector<uint64_t> counts(forest.maxDepth() + 1, 0);
  for (uint32_t v = 0; v < realVertices; ++v) ++counts[forest.id(v).depth];
  return counts;
}

// What of the mesh's attributes the options want.
AttributeLayout layoutOf(const ClosedMesh& mesh, const EncodeOptions& options) {
  return {options.colours && !mesh.colours.empty(), mesh.normals.empty() ? 0 : options.normalBits};
}

}  // namespace

Result<EncodedMesh> encodeFile(const std::filesystem::path& input, const EncodeOptions& options,
                               const EncodeProgress& progress) {
  std::vector<PhaseTime> reading;
  PhaseClock clock(reading, progress);
  clock.begin("read");
  if (const auto promised = promisedSize(input)) {
    std::error_code problem;
    const auto fileBytes = std::filesystem::file_size(input, problem);
    if (auto fit = fits(*promised, problem ? 0 : fileBytes, options); !fit)
      return fail(fit.error().code, input.string() + ": " + fit.error().message);
  }
  auto mesh = readMesh(input);
  if (!mesh) return tl::unexpected(mesh.error());
  clock.end();
  auto encoded = encodeMesh(std::move(*mesh), options, progress);
  if (!encoded) return fail(encoded.error().code, input.string() + ": " + encoded.error().message);
  encoded->report.phases.insert(encoded->report.phases.begin(), reading.front());
  return encoded;
}

Result<EncodedMesh> encodeMesh(IndexedMesh mesh, const EncodeOptions& options,
                               const EncodeProgress& progress) {
  EncodedMesh out;
  EncodingReport& report = out.report;
  PhaseClock clock(report.phases, progress);

  clock.begin("clean");
  report.notCarried = std::move(mesh.notCarried);
  const MeshSize size{mesh.positions.size(), mesh.triangles.size(), !mesh.colours.empty(),
                      !mesh.normals.empty()};
  if (auto fit = fits(size, 0, options); !fit) return tl::unexpected(fit.error());
  report.estimatedPeakBytes = estimateMemory(size, 0).peak();
  auto closed = closeMesh(std::move(mesh), report.cleaning);
  if (!closed) return tl::unexpected(closed.error());
  const Quantization quantization = quantizationFor(closed->positions, options.quantizationBits);
  std::vector<GridPosition> positions;
  positions.reserve(closed->positions.size());
  MeshMetadata& metadata = out.pack.metadata;
  metadata.boundsMin = metadata.boundsMax = closed->positions.front();
  for (const auto& p : closed->positions) {
    positions.push_back(quantization.toGrid(p));
    for (size_t i = 0; i < 3; ++i) {
      metadata.boundsMin[i] = std::min(metadata.boundsMin[i], p[i]);
      metadata.boundsMax[i] = std::max(metadata.boundsMax[i], p[i]);
    }
  }
  release(closed->positions);
  const AttributeLayout layout = layoutOf(*closed, options);
  const auto attributes = packAttributes(closed->colours, closed->normals, layout);
  release(closed->colours);
  release(closed->normals);
  // Cutting and closing may have made more of both.
  const MeshSize closedSize{positions.size() + closed->virtualCount, closed->triangles.size(),
                            layout.colours, layout.normalBits != 0};
  if (auto fit = fits(closedSize, 0, options); !fit) return tl::unexpected(fit.error());

  clock.begin("simplify");
  SimplifyOptions simplifyOptions;
  simplifyOptions.baseFraction =
      std::min(options.baseFraction,
               static_cast<double>(options.baseLimit) / static_cast<double>(positions.size()));
  simplifyOptions.balance = options.balance;
  simplifyOptions.maxValence = options.maxValence;
  Simplification simplification =
      simplify(positions, closed->virtualCount, closed->triangles, closed->realTriangleCount,
               simplifyOptions, [&](size_t done, size_t planned) {
                 clock.report(static_cast<double>(done) / static_cast<double>(planned));
               });
  report.simplification = simplification.report;
  if (simplification.report.why == StopReason::notClosed)
    return fail("cleaning did not make it a closed manifold; please report it");

  clock.begin("hierarchy");
  const VertexForest forest(positions, closed->virtualCount, simplification.collapses);
  release(simplification.collapses);
  report.maxDepth = forest.maxDepth();
  report.leavesByDepth = leavesByDepth(forest, positions.size());

  clock.begin("code");
  const CodingInput codingInput{
      positions, closed->virtualCount, closed->triangles, options.quantizationBits, layout,
      attributes};
  CodedMesh coded =
      codeMesh(codingInput, forest, options.threads, [&](uint64_t done, uint64_t planned) {
        clock.report(static_cast<double>(done) / static_cast<double>(planned));
      });
  clock.end();
  report.bits = coded.bits;
  report.tableBits = coded.tableBits;

  metadata.name = options.name;
  metadata.vertexCount = positions.size();
  metadata.triangleCount = closed->realTriangleCount;
  metadata.baseVertexCount = forest.realRootCount();
  metadata.baseTriangleCount = coded.baseTriangles;
  metadata.splitCount = forest.splitCount();
  metadata.maxLevel = forest.maxLevel();
  metadata.maxDepth = forest.maxDepth();
  metadata.quantization = quantization;
  if (layout.colours) metadata.attributes.emplace_back("colour");
  if (layout.normalBits != 0) metadata.attributes.emplace_back("normal");
  metadata.recordBytes = (coded.bits.total() + 7) / 8;
  out.pack.base = std::move(coded.base);
  out.pack.chunkIndex = std::move(coded.chunkIndex);
  out.pack.chunks = std::move(coded.chunks);
  out.pack.reportJson = toJson(report, false);
  return out;
}

}  // namespace meshfront
