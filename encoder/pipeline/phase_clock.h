// Times the phases of the encoding and says when one begins.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "encoder/pipeline/encode_mesh.h"
#include "encoder/pipeline/peak_memory.h"

namespace meshfront {

class PhaseClock {
 public:
  // Both outlive the clock.
  PhaseClock(std::vector<PhaseTime>& phases, const EncodeProgress& progress)
      : phases_(phases), progress_(progress) {}
  ~PhaseClock() { end(); }
  PhaseClock(const PhaseClock&) = delete;
  PhaseClock& operator=(const PhaseClock&) = delete;

  // Ends the phase before.
  void begin(const std::string& name) {
    end();
    phases_.push_back({name, 0, 0});
    running_ = true;
    forgetPeakMemory();
    started_ = std::chrono::steady_clock::now();
    report(0);
  }
  void end() {
    if (!running_) return;
    running_ = false;
    const auto now = std::chrono::steady_clock::now();
    phases_.back().seconds = std::chrono::duration<double>(now - started_).count();
    phases_.back().peakBytes = peakMemory();
  }
  // The share of the phase that is done.
  void report(double done) const {
    if (progress_) progress_(phases_.back().name, done);
  }

 private:
  std::vector<PhaseTime>& phases_;
  const EncodeProgress& progress_;
  std::chrono::steady_clock::time_point started_;
  bool running_ = false;
};

}  // namespace meshfront
