// Experiment 6, Kim, Lee and Kobbelt 2004, figures 5 and 6: what the server holds of a client that
// walks a path twice, and what goes up and down.
#include <algorithm>

#include "shared/receiver/request_budget.h"
#include "tests/evaluation/csv_file.h"
#include "tests/evaluation/sender_driven/message_stream.h"
#include "tests/evaluation/sender_experiments/experiments.h"

namespace meshfront::evaluation {
namespace {

// Answers the view; octets of the messages are added to `down`.
uint64_t answerWhole(SenderSession& session, const ViewRequest& view, uint64_t& down,
                     size_t& mostQueue) {
  session.look(view);
  mostQueue = std::max(mostQueue, session.queueBytes());
  uint64_t sent = 0;
  for (;;) {
    const SentBatch& batch = session.next(adaptiveBatch(session.sentCount()));
    if (batch.splits.empty()) break;
    down += kMessageHead + batch.message.size();
    sent += batch.splits.size();
    mostQueue = std::max(mostQueue, session.queueBytes());
  }
  down += kMessageHead;
  return sent;
}

Result<void> walkTwice(const MeasuredMesh& mesh, const CameraPath& path, float tolerance,
                       CsvFile& csv) {
  SenderSession tags(mesh.model, {});
  SenderOptions frontOptions;
  frontOptions.bookkeeping = Bookkeeping::vertexFront;
  SenderSession front(mesh.model, frontOptions);
  uint64_t up = 0;
  uint64_t down = helloBytes(mesh);
  uint64_t unused = 0;
  for (unsigned round = 0; round < 2; ++round)
    for (uint64_t frame = 0; frame < path.frameCount(); ++frame) {
      const ViewRequest view = mesh.view(path.at(path.frameTime(frame)), tolerance);
      size_t queue = 0;
      up += kMessageHead + ViewRequest::kBytes;
      const uint64_t sent = answerWhole(tags, view, down, queue);
      size_t frontQueue = 0;
      if (answerWhole(front, view, unused, frontQueue) != sent) return fail("two sessions differ");
      const uint64_t vertices = mesh.model.base().roots.size() + tags.sentCount();
      csv.row(mesh.name, tolerance, round * path.frameCount() + frame, round, tags.sentCount(),
              sent, tags.sessionBytes(), tags.singleWindowBytes(), front.sessionBytes(),
              sizeof(uint32_t) * vertices, queue, up, down);
    }
  return {};
}

}  // namespace

Result<void> measureSessions(std::span<MeasuredMesh> meshes, const ExperimentOptions& options) {
  CsvFile csv(options.output / "session.csv",
              {"mesh", "tolerance", "frame", "round", "sent", "new_splits", "tags_bytes",
               "single_window_bytes", "front_bytes", "all_vertices_bytes", "queue_bytes",
               "bytes_up", "bytes_down"});
  for (const MeasuredMesh& mesh : meshes) {
    CameraPathSpec spec = options.path;
    spec.rounds = 1;
    const auto path = CameraPath::place(spec, mesh.bounds, kPictureSize.aspect());
    if (!path) return tl::unexpected(path.error());
    for (const float tolerance : {0.0F, 1.0F})
      if (auto walked = walkTwice(mesh, *path, tolerance, csv); !walked) return walked;
  }
  return csv.close();
}

}  // namespace meshfront::evaluation
