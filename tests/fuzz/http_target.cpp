#include <optional>
#include <string>
#include <vector>

#include "shared/http/field_line.h"
#include "shared/http/server/content_reader.h"
#include "shared/http/server/request_head.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

constexpr size_t kMaxFields = 1024;

// What a connection's octets come to: its requests, and why it is closed.
struct Conversation {
  std::vector<std::string> requests;
  unsigned defect = 0;
  bool operator==(const Conversation&) const = default;
};

void checkHead(const RequestHead& head) {
  promise(isToken(head.method), "methods are tokens");
  promise(!head.target.empty() && head.target.size() < kMaxRequestLine, "targets are bounded");
  for (const char c : head.target)
    promise(static_cast<uint8_t>(c) > 0x20 && c != 0x7F, "targets have no control octets");
  promise(isText(head.ifNoneMatch) && isText(head.contentType), "values have no control octets");
  promise(!(head.chunked && head.hasLength), "a content has one length");
  promise(head.ifNoneMatch.size() + head.contentType.size() <= kMaxFields, "fields are bounded");
}

// Reads as a connection does, so many octets at a time.
class Reading {
 public:
  // False: no more is read.
  bool take(std::string_view bytes) {
    while (!bytes.empty()) {
      const size_t before = bytes.size();
      if (!content_) {
        head_->take(bytes);
        if (head_->state() == RequestHeadReader::State::defective) return end(head_->defect());
        if (head_->state() == RequestHeadReader::State::whole) {
          checkHead(head_->head());
          content_.emplace(head_->head(), kMaxFields);
        }
      } else {
        text_ += content_->take(bytes);
        if (content_->defect().status != 0) return end(content_->defect());
      }
      promise(bytes.size() < before || content_.has_value(), "reading gets on");
      if (content_ && content_->whole()) next();
    }
    return true;
  }
  Conversation conversation;

 private:
  bool end(const RequestDefect& defect) {
    promise(defect.status >= 400 && *defect.detail != '\0', "a defect is explained");
    conversation.defect = defect.status;
    return false;
  }
  void next() {
    const RequestHead& head = head_->head();
    conversation.requests.push_back(head.method + " " + head.target + " " + head.ifNoneMatch + " " +
                                    head.contentType + (head.keepAlive ? " keep " : " close ") +
                                    text_);
    head_.emplace(kMaxFields);
    content_.reset();
    text_.clear();
  }
  std::optional<RequestHeadReader> head_{kMaxFields};
  std::optional<ContentReader> content_;
  std::string text_;
};

}  // namespace

bool readHttp(Bytes input) {
  FuzzInput in(input);
  const size_t piece = in.byte() % 64 + size_t{1};
  const Bytes octets = in.rest();
  const std::string_view text(reinterpret_cast<const char*>(octets.data()), octets.size());
  Reading whole;
  whole.take(text);
  Reading pieces;
  for (size_t at = 0; at < text.size(); at += piece) {
    const std::string copy(text.substr(at, piece));
    if (!pieces.take(copy)) break;
  }
  promise(whole.conversation == pieces.conversation, "how octets come does not matter");
  return !whole.conversation.requests.empty() && whole.conversation.defect == 0;
}

}  // namespace meshfront::fuzz
