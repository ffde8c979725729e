// What each frame of a flight cost and showed, a line of CSV a frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "shared/result.h"

namespace meshfront {

struct FlightRow {
  uint64_t frame = 0;
  double time = 0;         // on the path, seconds
  uint64_t bytesDown = 0;  // totals, headers included
  uint64_t bytesUp = 0;
  uint64_t splits = 0;         // received so far
  uint64_t triangles = 0;      // in this picture's meshes
  std::optional<double> psnr;  // dB against the reference; empty without one
  std::string state;
  uint64_t collapses = 0;  // totals
  uint64_t resplits = 0;   // from what is kept
  uint64_t memory = 0;     // bytes of the meshes, CPU and GPU
  double finalShare = 0;   // of the covered pixels, those whose mesh is final
};

class FlightLog {
 public:
  // Writes the header line.
  [[nodiscard]] static Result<FlightLog> create(const std::filesystem::path& path);
  void write(const FlightRow& row);
  // An error if anything could not be written.
  Result<void> close();

 private:
  FlightLog(std::filesystem::path path, std::ofstream out)
      : path_(std::move(path)), out_(std::move(out)) {}
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace meshfront
