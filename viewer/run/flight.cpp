#include "viewer/run/flight.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <system_error>

namespace meshfront {
namespace {

using FlightClock = std::chrono::steady_clock;
using Outlook = FlownScene::Outlook;
using std::chrono::milliseconds;

constexpr milliseconds kLongestNap{50};

std::filesystem::path framePath(const std::filesystem::path& folder, uint64_t frame) {
  std::array<char, 40> name{};
  std::snprintf(name.data(), name.size(), "frame-%05llu.png",
                static_cast<unsigned long long>(frame));
  return folder / name.data();
}

class Flight {
 public:
  Flight(const CameraPath& path, FlownScene& scene, const FlightOptions& options)
      : path_(path), scene_(scene), options_(options) {}

  Result<FlightSummary> play() {
    if (Result<void> prepared = prepare(); !prepared) return tl::unexpected(prepared.error());
    summary_.framesOfPath = path_.frameCount();
    for (uint64_t frame = 0; frame < path_.frameCount() && !ended() && !summary_.stuck; ++frame) {
      if (options_.progress) options_.progress(frame, path_.frameCount());
      const Camera camera = path_.at(path_.frameTime(frame));
      const Result<Outlook> outlook =
          options_.pace == FlightPace::settled ? settle(camera) : pass(camera);
      if (!outlook) return tl::unexpected(outlook.error());
      if (ended() && *outlook != Outlook::settled) break;  // no half-made frame
      if (*outlook == Outlook::settled) ++summary_.settledFrames;
      summary_.stuck = options_.pace == FlightPace::settled && *outlook == Outlook::stuck;
      if (Result<void> kept = keep(frame, camera); !kept) return tl::unexpected(kept.error());
      ++summary_.frames;
    }
    if (measured_ > 0) summary_.meanPsnr = psnrSum_ / static_cast<double>(measured_);
    if (log_) {
      if (Result<void> closed = log_->close(); !closed) return tl::unexpected(closed.error());
    }
    return summary_;
  }

 private:
  [[nodiscard]] bool ended() const { return options_.ended && options_.ended(); }

  Result<void> prepare() {
    if (options_.frames) {
      std::error_code error;
      std::filesystem::create_directories(*options_.frames, error);
      if (error)
        return fail(ErrorCode::unavailable,
                    "cannot make the folder " + options_.frames->string() + ": " + error.message());
    }
    if (options_.log) {
      auto log = FlightLog::create(*options_.log);
      if (!log) return tl::unexpected(log.error());
      log_.emplace(std::move(*log));
    }
    return {};
  }

  Result<Outlook> settle(const Camera& camera) {
    while (true) {
      Result<Outlook> outlook = scene_.look(camera);
      if (!outlook || *outlook != Outlook::more || ended()) return outlook;
      scene_.wait(kLongestNap);
    }
  }

  // A frame's share of a second; drawing and writing do not count.
  Result<Outlook> pass(const Camera& camera) {
    const auto share = std::chrono::duration<double>(1 / path_.framesPerSecond());
    const auto due = FlightClock::now() + std::chrono::duration_cast<FlightClock::duration>(share);
    while (true) {
      Result<Outlook> outlook = scene_.look(camera);
      const auto now = FlightClock::now();
      if (!outlook || now >= due || ended()) return outlook;
      const auto left = std::chrono::duration_cast<milliseconds>(due - now);
      scene_.wait(std::clamp(left, milliseconds(1), kLongestNap));
    }
  }

  Result<void> keep(uint64_t frame, const Camera& camera) {
    FlightRow row = scene_.row();
    row.frame = frame;
    row.time = path_.frameTime(frame);
    if (options_.frames || options_.log) {
      const Result<Picture> picture = scene_.picture(camera);
      if (!picture) return tl::unexpected(picture.error());
      const auto psnr = scene_.psnr(camera, *picture);
      if (!psnr) return tl::unexpected(psnr.error());
      row.psnr = *psnr;
      if (options_.frames) {
        if (Result<void> written = writePng(*picture, framePath(*options_.frames, frame)); !written)
          return written;
      }
    }
    if (row.psnr) {
      psnrSum_ += *row.psnr;
      ++measured_;
      summary_.lowestPsnr = std::min(summary_.lowestPsnr.value_or(*row.psnr), *row.psnr);
    }
    if (log_) log_->write(row);
    return {};
  }

  const CameraPath& path_;
  FlownScene& scene_;
  const FlightOptions& options_;
  std::optional<FlightLog> log_;
  FlightSummary summary_;
  double psnrSum_ = 0;
  uint64_t measured_ = 0;
};

}  // namespace

Result<FlightSummary> fly(const CameraPath& path, FlownScene& scene, const FlightOptions& options) {
  return Flight(path, scene, options).play();
}

}  // namespace meshfront
