// What evaluate-sender measures; each writes its CSV files into a folder.
#pragma once

#include <filesystem>
#include <span>

#include "shared/result.h"
#include "tests/evaluation/sender_experiments/measured_mesh.h"
#include "viewer/run/camera_path.h"

namespace meshfront::evaluation {

struct ExperimentOptions {
  std::filesystem::path output;
  bool quick = false;        // fewer repetitions, receivers and frames
  double headerBytes = 300;  // of each of our answers
  CameraPathSpec path;       // walked twice
};

// sender_cost.csv: the whole mesh by parts, both ways. The best of some runs.
Result<void> measureWholeMesh(std::span<MeasuredMesh> meshes, const ExperimentOptions& options);
// receivers.csv: many receivers, each on a path of its own.
Result<void> measureReceivers(std::span<MeasuredMesh> meshes, const ExperimentOptions& options);
// bytes.csv: what goes over a sender-driven connection, by coding of IDs.
Result<void> measureBytes(std::span<MeasuredMesh> meshes, const ExperimentOptions& options);
// session.csv: memory a session and bytes along the path.
Result<void> measureSessions(std::span<MeasuredMesh> meshes, const ExperimentOptions& options);
// client.csv: triangles, refinement and drawing along the path; pictures.csv and PNG files: fixed
// tolerance and fixed bytes. Needs OpenGL.
Result<void> measureClient(std::span<MeasuredMesh> meshes, const ExperimentOptions& options);

}  // namespace meshfront::evaluation
