// What a run cost and gained, a line of CSV for each applied answer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

#include "shared/result.h"

namespace meshfront {

struct TraceRow {
  double seconds = 0;     // since the program started
  uint64_t requests = 0;  // these and all that follow are totals, not differences
  uint64_t records = 0;
  uint64_t bytesUp = 0;            // octets of HTTP, headers included
  uint64_t bytesDown = 0;          // likewise
  uint64_t triangles = 0;          // drawn
  uint64_t visibleCandidates = 0;  // front vertices that cover pixels and can be split
  std::optional<double> psnr;      // dB against the reference; empty without one
};

class TraceWriter {
 public:
  // Writes the header line.
  [[nodiscard]] static Result<TraceWriter> create(const std::filesystem::path& path);
  void write(const TraceRow& row);
  // An error if anything could not be written.
  Result<void> close();

 private:
  TraceWriter(std::filesystem::path path, std::ofstream out)
      : path_(std::move(path)), out_(std::move(out)) {}
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace meshfront
