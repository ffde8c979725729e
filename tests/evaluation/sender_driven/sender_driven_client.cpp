// sender-driven-client: one view of a sender-driven server's mesh, refined until it is settled, and
// when what came.
//
//   sender-driven-client 127.0.0.1:8090 --camera half --json --log arrivals.csv
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "shared/camera/camera_spec.h"
#include "shared/program/interrupt.h"
#include "tests/evaluation/sender_driven/hello_messages.h"
#include "tests/evaluation/sender_driven/message_stream.h"
#include "tests/evaluation/sender_driven/split_message.h"

namespace meshfront::evaluation {
namespace {

struct ClientOptions {
  std::string server;
  CameraHello camera{"", {500, 500}, 0};
  bool cameraFirst = false;
  bool criteria = false;
  uint64_t dropAfter = 0;  // records; 0: never
  std::string log;
  bool json = false;
};

struct Arrival {
  double seconds = 0;
  uint64_t bytes = 0;
  uint64_t records = 0;
};

class Client {
 public:
  explicit Client(const ClientOptions& options) : options_(options) {}

  Result<void> run() {
    if (auto connected = connect(); !connected) return connected;
    for (;;) {
      auto message = stream_->receive();
      if (!message) return tl::unexpected(message.error());
      if (!*message) return fail(ErrorCode::unavailable, "the server ended the connection");
      if ((*message)->kind == MessageKind::settled) break;
      if (auto taken = take(**message); !taken) return taken;
      note();
      if (options_.dropAfter > 0 && !dropped_ && records_ >= options_.dropAfter)
        if (auto again = reconnect(); !again) return again;
    }
    settled_ = seconds();
    bytesUp_ += stream_->bytesSent();
    return writeLog();
  }

  [[nodiscard]] nlohmann::json summary() const {
    nlohmann::json received = nlohmann::json::array();
    for (const Arrival& arrival : arrivals_)
      received.push_back({arrival.seconds, arrival.bytes, arrival.records});
    return {{"settledSeconds", settled_},
            {"bytesUp", bytesUp_},
            {"bytesDown", arrivals_.empty() ? 0 : arrivals_.back().bytes},
            {"records", records_},
            {"triangles", mesh_ ? mesh_->drawnTriangleCount() : 0},
            {"complete", mesh_ && mesh_->complete()},
            {"received", received}};
  }

 private:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  Result<void> connect() {
    auto stream = MessageStream::connect(options_.server);
    if (!stream) return tl::unexpected(stream.error());
    stream_.emplace(std::move(*stream));
    if (options_.criteria)
      if (auto sent = stream_->send(MessageKind::criteria, {}); !sent) return sent;
    if (mesh_)
      if (auto sent = stream_->send(MessageKind::resume, encodeLeafList(*mesh_)); !sent)
        return sent;
    if (options_.cameraFirst) return stream_->send(MessageKind::camera, options_.camera.toBytes());
    return mesh_ ? sendView() : Result<void>();
  }
  Result<void> reconnect() {
    dropped_ = true;
    bytesUp_ += stream_->bytesSent();
    bytesBefore_ += stream_->bytesReceived();
    session_ = {};
    stream_.reset();
    return connect();
  }
  Result<void> sendView() {
    const auto view = options_.camera.viewOf(hello_);
    if (!view) return tl::unexpected(view.error());
    return stream_->send(MessageKind::view, view->toBytes());
  }

  Result<void> take(const Message& message) {
    if (message.kind == MessageKind::mesh) {
      if (mesh_) return {};  // after a new connection it is the same
      auto hello = MeshHello::fromBytes(message.content);
      if (!hello) return tl::unexpected(hello.error());
      hello_ = std::move(*hello);
      auto base = decodeBaseMesh(hello_.base);
      if (!base) return tl::unexpected(base.error());
      auto mesh = SelectivelyRefinedMesh::fromBase(std::move(*base));
      if (!mesh) return tl::unexpected(mesh.error());
      mesh_.emplace(std::move(*mesh));
      return options_.cameraFirst ? Result<void>() : sendView();
    }
    if (message.kind != MessageKind::splits || !mesh_)
      return fail("the server sent a message of an unknown kind");
    const auto applied = applySplitMessage(message.content, *mesh_, session_);
    if (!applied) return tl::unexpected(applied.error());
    records_ += *applied;
    return {};
  }

  void note() {
    arrivals_.push_back({seconds(), bytesBefore_ + stream_->bytesReceived(), records_});
  }
  [[nodiscard]] Result<void> writeLog() const {
    if (options_.log.empty()) return {};
    std::ofstream out(options_.log);
    out << "seconds,bytes,records\n";
    for (const Arrival& arrival : arrivals_)
      out << arrival.seconds << ',' << arrival.bytes << ',' << arrival.records << '\n';
    out.close();
    if (!out) return fail(options_.log + ": cannot be written");
    return {};
  }

  const ClientOptions& options_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::optional<MessageStream> stream_;
  MeshHello hello_;
  std::optional<SelectivelyRefinedMesh> mesh_;
  ClientSession session_;
  std::vector<Arrival> arrivals_;
  uint64_t records_ = 0;
  uint64_t bytesUp_ = 0;
  uint64_t bytesBefore_ = 0;  // of connections before this one
  double settled_ = 0;
  bool dropped_ = false;
};

std::optional<PixelSize> parseSize(const std::string& text) {
  PixelSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%c", &size.width, &size.height, &rest) != 2 ||
      size.width < 1 || size.height < 1 || size.width > 16384 || size.height > 16384)
    return std::nullopt;
  return size;
}

}  // namespace
}  // namespace meshfront::evaluation

int main(int argc, char** argv) {
  using namespace meshfront::evaluation;
  ClientOptions options;
  std::string size = "500x500";
  CLI::App app{"Refines one view of a sender-driven server's mesh and tells when what came."};
  app.add_option("SERVER", options.server, "HOST:PORT")->required();
  app.add_option("--camera", options.camera.camera, std::string(meshfront::kCameraSpecHelp));
  app.add_option("--size", size, "of the picture, pixels")->capture_default_str();
  app.add_option("--tolerance", options.camera.tolerance,
                 "error that may stay, pixels; 0: none of what may be seen")
      ->capture_default_str();
  app.add_flag("--camera-first", options.cameraFirst,
               "sends the camera in words with the connection, which saves a round trip");
  app.add_flag("--criteria", options.criteria, "asks for each node's criteria, to coarsen by them");
  app.add_option("--drop-after", options.dropAfter,
                 "loses the connection after so many records and resumes")
      ->capture_default_str();
  app.add_option("--log", options.log, "CSV: seconds,bytes,records, a line a message");
  app.add_flag("--json", options.json, "prints JSON; received: [seconds, bytes, records]");
  try {
    app.parse(argc, argv);
    const auto parsed = parseSize(size);
    if (!parsed) throw CLI::ValidationError("--size", "must be WIDTHxHEIGHT");
    options.camera.picture = *parsed;
    const auto camera = meshfront::parseCameraSpec(options.camera.camera);
    if (!camera) throw CLI::ValidationError("--camera", camera.error().message);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  meshfront::catchInterrupts();
  Client client(options);
  const auto done = client.run();
  const nlohmann::json summary = client.summary();
  if (options.json) {
    std::cout << summary.dump() << '\n';
  } else {
    std::cout << summary["records"] << " records, " << summary["bytesDown"] << " bytes down, "
              << summary["bytesUp"] << " up, settled after " << summary["settledSeconds"] << " s\n";
  }
  if (!done) {
    std::cerr << "sender-driven-client: " << done.error().message << '\n';
    return 1;
  }
  return 0;
}
