#include "tests/evaluation/sender_driven/message_stream.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "shared/http/server/listen_address.h"
#include "shared/program/interrupt.h"

namespace meshfront::evaluation {
namespace {

constexpr int kLookMilliseconds = 200;  // how long an interrupt may go unseen

tl::unexpected<Error> brokenConnection() {
  return fail(ErrorCode::unavailable, std::string("the connection broke: ") + std::strerror(errno));
}

}  // namespace

MessageStream::MessageStream(int socket) : socket_(socket) {
  const int on = 1;
  (void)setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
}

Result<MessageStream> MessageStream::connect(std::string_view address) {
  const auto resolved = resolveListenAddress(address);
  if (!resolved) return tl::unexpected(resolved.error());
  const int socket = ::socket(resolved->socketAddress.ss_family, SOCK_STREAM, 0);
  if (socket < 0) return brokenConnection();
  MessageStream stream(socket);
  const auto* place = reinterpret_cast<const sockaddr*>(&resolved->socketAddress);
  if (::connect(socket, place, sizeof(resolved->socketAddress)) != 0)
    return fail(ErrorCode::unavailable,
                "cannot connect to " + std::string(address) + ": " + std::strerror(errno));
  return stream;
}

MessageStream::MessageStream(MessageStream&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), sent_(other.sent_), received_(other.received_) {}

MessageStream& MessageStream::operator=(MessageStream&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(sent_, other.sent_);
  std::swap(received_, other.received_);
  return *this;
}

MessageStream::~MessageStream() {
  if (socket_ >= 0) close(socket_);
}

Result<void> MessageStream::send(MessageKind kind, std::span<const uint8_t> content) {
  if (content.size() > kMostMessageBytes) return fail(ErrorCode::tooLarge, "a message is too long");
  std::vector<uint8_t> bytes{static_cast<uint8_t>(kind), static_cast<uint8_t>(content.size() >> 16),
                             static_cast<uint8_t>(content.size() >> 8),
                             static_cast<uint8_t>(content.size())};
  bytes.insert(bytes.end(), content.begin(), content.end());
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR && !interrupted()) continue;
    if (count < 0) return brokenConnection();
    done += static_cast<size_t>(count);
    sent_ += static_cast<uint64_t>(count);
  }
  return {};
}

Result<std::optional<Message>> MessageStream::receive() {
  std::array<uint8_t, kMessageHead> head{};
  const auto begun = receiveAll(head);
  if (!begun) return tl::unexpected(begun.error());
  if (!*begun) return std::nullopt;
  Message message;
  message.kind = static_cast<MessageKind>(head[0]);
  message.content.resize(size_t{head[1]} << 16 | size_t{head[2]} << 8 | head[3]);
  const auto all = receiveAll(message.content);
  if (!all) return tl::unexpected(all.error());
  if (!*all && !message.content.empty())
    return fail(ErrorCode::unavailable, "the connection ended within a message");
  return std::optional<Message>(std::move(message));
}

Result<bool> MessageStream::receiveAll(std::span<uint8_t> into) {
  for (size_t done = 0; done < into.size();) {
    pollfd waiting{socket_, POLLIN, 0};
    const int ready = poll(&waiting, 1, kLookMilliseconds);
    if (interrupted()) return fail(ErrorCode::unavailable, "interrupted");
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = recv(socket_, into.data() + done, into.size() - done, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return brokenConnection();
    if (count == 0) {
      if (done == 0) return false;
      return fail(ErrorCode::unavailable, "the connection ended within a message");
    }
    done += static_cast<size_t>(count);
    received_ += static_cast<uint64_t>(count);
  }
  return true;
}

bool MessageStream::hasArrived() const {
  pollfd waiting{socket_, POLLIN, 0};
  return poll(&waiting, 1, 0) > 0;
}

}  // namespace meshfront::evaluation
