// A TCP connection that carries messages: four octets, the kind and the length (24 bits,
// big-endian), then the content.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "shared/result.h"

namespace meshfront::evaluation {

enum class MessageKind : uint8_t {
  // to the server
  criteria = 1,  // send each node's criteria with its record; before the first view
  view = 2,      // view_request.h
  resume = 3,    // encodeLeafList()
  camera = 4,  // in place of the first view: the server knows the bounds already (hello_messages.h)
  // to the client
  mesh = 16,     // hello_messages.h; at once
  splits = 17,   // split_message.h
  settled = 18,  // the view has all it asks for; empty
};

struct Message {
  MessageKind kind = MessageKind::settled;
  std::vector<uint8_t> content;
};

inline constexpr size_t kMessageHead = 4;
inline constexpr size_t kMostMessageBytes = (size_t{1} << 24) - 1;

// Owns the socket. Not thread-safe.
class MessageStream {
 public:
  explicit MessageStream(int socket);
  // `address`: HOST:PORT.
  [[nodiscard]] static Result<MessageStream> connect(std::string_view address);
  MessageStream(MessageStream&& other) noexcept;
  MessageStream& operator=(MessageStream&& other) noexcept;
  MessageStream(const MessageStream&) = delete;
  MessageStream& operator=(const MessageStream&) = delete;
  ~MessageStream();

  Result<void> send(MessageKind kind, std::span<const uint8_t> content);
  // Waits; nullopt where the peer has closed the connection. Untrusted. ErrorCode::unavailable for
  // a connection that breaks, and when the program is to end (interrupted()).
  [[nodiscard]] Result<std::optional<Message>> receive();
  // Something has come (or the connection has ended): receive() will not wait for long.
  [[nodiscard]] bool hasArrived() const;

  [[nodiscard]] uint64_t bytesSent() const { return sent_; }
  [[nodiscard]] uint64_t bytesReceived() const { return received_; }

 private:
  // False at the end of the connection before the first octet.
  [[nodiscard]] Result<bool> receiveAll(std::span<uint8_t> into);

  int socket_;
  uint64_t sent_ = 0;
  uint64_t received_ = 0;
};

}  // namespace meshfront::evaluation
