// Experiment 6, Kim, Lee and Kobbelt 2004, figures 7 to 9: what the client holds and computes along
// a path, and pictures at a fixed tolerance and at fixed bytes.
#include <algorithm>
#include <functional>

#include "shared/receiver/request_budget.h"
#include "tests/evaluation/csv_file.h"
#include "tests/evaluation/sender_driven/message_stream.h"
#include "tests/evaluation/sender_experiments/drawn_client.h"
#include "tests/evaluation/sender_experiments/experiments.h"

namespace meshfront::evaluation {
namespace {

constexpr unsigned kSettles = 30;      // rounds, about
constexpr unsigned kRoundsAFrame = 2;  // of a client that moves
constexpr double kSamePicture = 99;    // dB, in place of infinity

Result<void> walk(const MeasuredMesh& mesh, const CameraPath& path, DrawingTools& tools,
                  CsvFile& csv) {
  auto client = DrawnClient::create(mesh, tools);
  if (!client) return tl::unexpected(client.error());
  const uint64_t frames = path.frameCount();
  for (uint64_t frame = 0; frame < 2 * frames; ++frame) {
    const Camera camera = path.at(path.frameTime(frame % frames));
    const auto refined = client->refine(camera, frame == 0 ? kSettles : kRoundsAFrame);
    if (!refined) return tl::unexpected(refined.error());
    double drawing = 0;
    for (int i = 0; i < 2; ++i) {
      const auto seconds = client->timeDrawing(camera);
      if (!seconds) return tl::unexpected(seconds.error());
      drawing = i == 0 ? *seconds : std::min(drawing, *seconds);
    }
    csv.row(mesh.name, frame, frame / frames, client->mesh().drawnTriangleCount(),
            client->mesh().recordsHeld(), refined->records, refined->splits, refined->collapses,
            1e3 * refined->seconds, 1e3 * drawing, client->mesh().memoryBytes());
  }
  return {};
}

// What pictures of a mesh are compared with: the whole of it, on the same grid.
class PictureSeries {
 public:
  static Result<PictureSeries> create(const MeasuredMesh& mesh, DrawingTools& tools,
                                      const ExperimentOptions& options, CsvFile& csv) {
    PictureSeries series(mesh, tools, options, csv);
    auto client = DrawnClient::create(mesh, tools);
    if (!client) return tl::unexpected(client.error());
    for (uint32_t node = 0; node < mesh.model.nodeCount(); ++node) {
      const auto known = client->mesh().find(mesh.model.id(node));
      if (!known ||
          !client->mesh().split(*known, mesh.model.recordBytes(), mesh.model.recordBegin(node),
                                mesh.model.recordBits(node)))
        return fail("the whole mesh does not come together");
    }
    auto whole = client->draw(series.camera_);
    if (!whole) return tl::unexpected(whole.error());
    series.whole_ = std::move(*whole);
    return series;
  }

  // A sender-driven client until `enough(octets down)`, or settled. 0 dB on top: written.
  Result<double> sender(const char* file, SenderOrder order, float tolerance, uint64_t mostBytes) {
    SenderOptions options;
    options.order = order;
    SenderSession session(*model_, options);
    auto client = DrawnClient::create(*mesh_, *tools_);
    if (!client) return tl::unexpected(client.error());
    ClientSession state;
    session.look(mesh_->view(camera_, tolerance));
    uint64_t bytes = helloBytes(*mesh_);
    while (bytes < mostBytes) {
      // The last batch is cut so that it ends at the bytes wanted, about.
      const uint64_t room = (mostBytes - bytes) / 5 + 1;
      const SentBatch& batch =
          session.next(std::min<uint64_t>(adaptiveBatch(session.sentCount()), room));
      if (batch.splits.empty()) break;
      bytes += kMessageHead + batch.message.size();
      const auto applied = applySplitMessage(batch.message, client->mesh(), state);
      if (!applied) return tl::unexpected(applied.error());
    }
    return write(file, order == SenderOrder::error ? "sender-driven" : "sender-driven by level",
                 *client, tolerance, bytes);
  }

  // Ours until the bytes or the PSNR are reached, or settled.
  Result<double> ours(const char* file, uint64_t mostBytes, double decibels) {
    auto client = DrawnClient::create(*mesh_, *tools_);
    if (!client) return tl::unexpected(client.error());
    double bytes = static_cast<double>(model_->baseBytes().size()) + 2 * headerBytes_ +
                   static_cast<double>(toJson(mesh_->pack->metadata()).size());
    uint64_t up = 0;
    while (bytes < static_cast<double>(mostBytes)) {
      if (decibels < kSamePicture) {
        const auto reached = psnr(*client);
        if (!reached) return tl::unexpected(reached.error());
        if (*reached >= decibels) break;
      }
      const auto answer = client->fetch(camera_, up);
      if (!answer) return tl::unexpected(answer.error());
      if (*answer == 0) break;
      bytes += static_cast<double>(*answer) + headerBytes_;
    }
    return write(file, "receiver-driven", *client, 0, static_cast<uint64_t>(bytes));
  }

 private:
  PictureSeries(const MeasuredMesh& mesh, DrawingTools& tools, const ExperimentOptions& options,
                CsvFile& csv)
      : mesh_(&mesh),
        model_(&mesh.model),
        tools_(&tools),
        folder_(options.output),
        headerBytes_(options.headerBytes),
        csv_(&csv),
        camera_(mesh.camera("whole")) {}

  Result<double> psnr(DrawnClient& client) {
    const auto picture = client.draw(camera_);
    if (!picture) return tl::unexpected(picture.error());
    const auto value = peakSignalToNoise(*picture, whole_);
    if (!value) return tl::unexpected(value.error());
    return std::min(*value, kSamePicture);
  }
  Result<double> write(const char* kind, const char* way, DrawnClient& client, float tolerance,
                       uint64_t bytes) {
    auto value = psnr(client);
    if (!value) return value;
    const std::string file = mesh_->name + "_" + kind + ".png";
    const auto picture = client.draw(camera_);
    if (!picture) return tl::unexpected(picture.error());
    if (auto written = writePng(*picture, folder_ / file); !written)
      return tl::unexpected(written.error());
    csv_->row(mesh_->name, file, way, tolerance, bytes, client.mesh().splitsApplied(),
              client.mesh().drawnTriangleCount(), *value);
    return value;
  }

  const MeasuredMesh* mesh_;
  const SenderModel* model_;
  DrawingTools* tools_;
  std::filesystem::path folder_;
  double headerBytes_;
  CsvFile* csv_;
  Camera camera_;
  Picture whole_;
};

Result<void> drawPictures(const MeasuredMesh& mesh, DrawingTools& tools,
                          const ExperimentOptions& options, CsvFile& csv) {
  auto series = PictureSeries::create(mesh, tools, options, csv);
  if (!series) return tl::unexpected(series.error());
  const uint64_t bytes = 4000 + mesh.model.nodeCount() / 4;  // some 6 % of the records
  const auto byTolerance = series->sender("tolerance_sender", SenderOrder::error, 1, UINT64_MAX);
  if (!byTolerance) return tl::unexpected(byTolerance.error());
  const std::array steps{
      std::function([&] { return series->ours("tolerance_ours", UINT64_MAX, *byTolerance); }),
      std::function([&] { return series->sender("bytes_sender", SenderOrder::error, 0, bytes); }),
      std::function([&] {
        return series->sender("bytes_sender_level", SenderOrder::significance, 0, bytes);
      }),
      std::function([&] { return series->ours("bytes_ours", bytes, kSamePicture); })};
  for (const auto& step : steps)
    if (const auto done = step(); !done) return tl::unexpected(done.error());
  return {};
}

}  // namespace

Result<void> measureClient(std::span<MeasuredMesh> meshes, const ExperimentOptions& options) {
  auto tools = DrawingTools::create();
  if (!tools) return tl::unexpected(tools.error());
  CsvFile walked(options.output / "client.csv",
                 {"mesh", "frame", "round", "triangles", "records", "new_records", "splits_again",
                  "collapses", "refinement_ms", "drawing_ms", "mesh_bytes"});
  CsvFile pictures(options.output / "pictures.csv", {"mesh", "file", "way", "tolerance",
                                                     "bytes_down", "records", "triangles", "psnr"});
  for (const MeasuredMesh& mesh : meshes) {
    CameraPathSpec spec = options.path;
    spec.rounds = 1;
    const auto path = CameraPath::place(spec, mesh.bounds, kPictureSize.aspect());
    if (!path) return tl::unexpected(path.error());
    if (auto done = walk(mesh, *path, *tools, walked); !done) return done;
    if (auto done = drawPictures(mesh, *tools, options, pictures); !done) return done;
  }
  if (auto closed = walked.close(); !closed) return closed;
  return pictures.close();
}

}  // namespace meshfront::evaluation
