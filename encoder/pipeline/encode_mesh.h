// The whole way from a mesh file to the content of a pack.
//
//   file -> clean, close -> quantise -> simplify -> vertex forest -> code -> pack content + report
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "encoder/cleaning/close_mesh.h"
#include "encoder/coding/mesh_coder.h"
#include "encoder/simplification/simplify.h"
#include "shared/result.h"
#include "shared/store/pack.h"

namespace meshfront {

struct EncodeOptions {
  std::string name;  // of the mesh in the catalogue; see isMeshName()
  unsigned quantizationBits = kDefaultQuantizationBits;
  bool colours = true;                       // carry the input's, if it has any
  unsigned normalBits = kDefaultNormalBits;  // of each coordinate of normals; 0: leave them out
  double baseFraction = 0.002;               // of the vertices, wanted in the base mesh
  uint64_t baseLimit = 4000;  // and at most that many: the first picture is not to wait for more
  unsigned balance = 1;
  uint32_t maxValence = SimplifyOptions{}.maxValence;
  unsigned threads = 2;  // changes the time, never the result
  // Bytes that the process may take. Work that is estimated to need more (memory_estimate.h) is
  // refused before it starts, as ErrorCode::tooLarge.
  uint64_t memoryLimit = UINT64_MAX;
  std::string memoryLimitedBy = "the memory limit";  // what set it, for the message
};

struct PhaseTime {
  std::string name;
  double seconds = 0;
  uint64_t peakBytes = 0;  // the most memory of the process during the phase
};

struct EncodingReport {
  std::vector<std::string> notCarried;  // of the file's mesh, a sentence each
  CleaningReport cleaning;
  SimplifyReport simplification;
  FieldBits bits;
  uint64_t tableBits = 0;
  unsigned maxDepth = 0;
  std::vector<uint64_t> leavesByDepth;
  uint64_t estimatedPeakBytes = 0;  // as told before the work, but for reading
  std::vector<PhaseTime> phases;
};

struct EncodedMesh {
  PackContent pack;  // reportJson holds what of the report is a constant of the mesh
  EncodingReport report;
};

// Phase's name and its share done, 0 .. 1.
using EncodeProgress = std::function<void(const std::string& phase, double done)>;

[[nodiscard]] Result<EncodedMesh> encodeFile(const std::filesystem::path& input,
                                             const EncodeOptions& options,
                                             const EncodeProgress& progress = {});
// The same for a mesh at hand, which is used up.
[[nodiscard]] Result<EncodedMesh> encodeMesh(IndexedMesh mesh, const EncodeOptions& options,
                                             const EncodeProgress& progress = {});

// The report as JSON: "notCarried", "cleaning", "simplification", "bits", "depths"; "phases" only
// if `withTimes`.
[[nodiscard]] std::string toJson(const EncodingReport& report, bool withTimes);
// For people, several lines.
[[nodiscard]] std::string describe(const EncodingReport& report);

}  // namespace meshfront
