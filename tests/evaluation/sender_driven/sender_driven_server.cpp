// sender-driven-server: one mesh for sender-driven clients, a session and a thread each.
//
//   sender-driven-server bunny.pack --listen 127.0.0.1:0
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <list>
#include <map>
#include <thread>

#include "shared/http/server/listen_address.h"
#include "shared/program/interrupt.h"
#include "shared/receiver/request_budget.h"
#include "tests/evaluation/sender_driven/hello_messages.h"
#include "tests/evaluation/sender_driven/message_stream.h"
#include "tests/evaluation/sender_driven/sender_session.h"

namespace meshfront::evaluation {
namespace {

constexpr int kBacklog = 128;
constexpr int kLookAgain = 200;  // milliseconds

struct ServerOptions {
  std::string pack;
  std::string listen = "127.0.0.1:0";
  SenderOptions sender;
};

// One client's connection, until it ends.
class Conversation {
 public:
  Conversation(const SenderModel& model, const MeshHello& hello, const SenderOptions& options,
               MessageStream stream)
      : model_(model),
        hello_(hello),
        options_(options),
        stream_(std::move(stream)),
        session_(std::make_unique<SenderSession>(model, options)) {}

  Result<void> run() {
    if (auto sent = stream_.send(MessageKind::mesh, hello_.toBytes()); !sent) return sent;
    bool sending = false;  // the view has not got all yet
    for (;;) {
      // A new view counts at once; without one the view before goes on.
      while (!sending || stream_.hasArrived()) {
        const auto message = stream_.receive();
        if (!message) return tl::unexpected(message.error());
        if (!*message) return {};
        const auto hasView = take(**message);
        if (!hasView) return tl::unexpected(hasView.error());
        sending = sending || *hasView;
      }
      const SentBatch& batch = session_->next(adaptiveBatch(session_->sentCount()));
      sending = !batch.splits.empty();
      auto sent = sending ? stream_.send(MessageKind::splits, batch.message)
                          : stream_.send(MessageKind::settled, {});
      if (!sent) return sent;
    }
  }

 private:
  // True for a view.
  Result<bool> take(const Message& message) {
    if (message.kind == MessageKind::criteria) {
      options_.criteria = true;
      session_ = std::make_unique<SenderSession>(model_, options_);
      return false;
    }
    if (message.kind == MessageKind::resume) {
      if (auto resumed = session_->resume(message.content); !resumed)
        return tl::unexpected(resumed.error());
      return false;
    }
    Result<ViewRequest> view = fail("a message of an unknown kind");
    if (message.kind == MessageKind::view) {
      view = ViewRequest::fromBytes(message.content);
    } else if (message.kind == MessageKind::camera) {
      const auto camera = CameraHello::fromBytes(message.content);
      if (!camera) return tl::unexpected(camera.error());
      view = camera->viewOf(hello_);
    }
    if (!view) return tl::unexpected(view.error());
    session_->look(*view);
    return true;
  }

  const SenderModel& model_;
  const MeshHello& hello_;
  SenderOptions options_;
  MessageStream stream_;
  std::unique_ptr<SenderSession> session_;
};

Result<int> listenAt(const std::string& text) {
  auto address = resolveListenAddress(text);
  if (!address) return tl::unexpected(address.error());
  const int socket = ::socket(address->socketAddress.ss_family, SOCK_STREAM, 0);
  const int on = 1;
  (void)setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  auto* place = reinterpret_cast<sockaddr*>(&address->socketAddress);
  socklen_t length = sizeof(address->socketAddress);
  if (socket < 0 || bind(socket, place, length) != 0 || listen(socket, kBacklog) != 0)
    return fail("cannot listen on " + text + ": " + std::strerror(errno));
  (void)getsockname(socket, place, &length);
  const auto* four = reinterpret_cast<const sockaddr_in*>(place);
  const auto* six = reinterpret_cast<const sockaddr_in6*>(place);
  const unsigned port = ntohs(place->sa_family == AF_INET6 ? six->sin6_port : four->sin_port);
  std::printf("listening on %s:%u\n", address->host.c_str(), port);
  std::fflush(stdout);
  return socket;
}

Result<void> serve(const ServerOptions& options) {
  const auto pack = Pack::open(options.pack);
  if (!pack) return tl::unexpected(pack.error());
  const auto model = SenderModel::load(**pack);
  if (!model) return tl::unexpected(model.error());
  const MeshMetadata& metadata = (*pack)->metadata();
  const MeshHello hello{metadata.quantization,
                        metadata.boundsMin,
                        metadata.boundsMax,
                        {model->baseBytes().begin(), model->baseBytes().end()}};
  const auto socket = listenAt(options.listen);
  if (!socket) return tl::unexpected(socket.error());
  std::list<std::jthread> conversations;
  while (!interrupted()) {
    pollfd waiting{*socket, POLLIN, 0};
    if (poll(&waiting, 1, kLookAgain) <= 0) continue;
    const int client = accept(*socket, nullptr, nullptr);
    if (client < 0) continue;
    conversations.emplace_back([&, client] {
      const auto ended = Conversation(*model, hello, options.sender, MessageStream(client)).run();
      if (!ended && !interrupted())
        std::fprintf(stderr, "sender-driven-server: %s\n", ended.error().message.c_str());
    });
  }
  close(*socket);
  return {};
}

}  // namespace
}  // namespace meshfront::evaluation

int main(int argc, char** argv) {
  using namespace meshfront::evaluation;
  ServerOptions options;
  CLI::App app{"Serves one mesh to sender-driven clients (sender-driven-client) over TCP."};
  app.add_option("PACK", options.pack, "as meshfront-encode writes it")->required();
  app.add_option("--listen", options.listen, "HOST:PORT; port 0: a free one, which is printed")
      ->capture_default_str();
  const std::map<std::string, SenderOrder> orders{{"error", SenderOrder::error},
                                                  {"significance", SenderOrder::significance}};
  app.add_option("--order", options.sender.order,
                 "error: by error in pixels, as published (default); significance: by level first")
      ->transform(CLI::CheckedTransformer(orders));
  const std::map<std::string, IdCoding> codings{{"published", IdCoding::published},
                                                {"bitstring", IdCoding::bitstring},
                                                {"adaptive", IdCoding::adaptive}};
  app.add_option("--ids", options.sender.ids,
                 "how IDs are coded: published, bitstring or adaptive (default)")
      ->transform(CLI::CheckedTransformer(codings));
  const std::map<std::string, Bookkeeping> kinds{{"tags", Bookkeeping::windowedTags},
                                                 {"front", Bookkeeping::vertexFront}};
  app.add_option("--bookkeeping", options.sender.bookkeeping,
                 "what is kept of a client: windowed tags (default) or its front")
      ->transform(CLI::CheckedTransformer(kinds));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  meshfront::catchInterrupts();
  if (const auto served = serve(options); !served) {
    std::fprintf(stderr, "sender-driven-server: %s\n", served.error().message.c_str());
    return 1;
  }
  return 0;
}
