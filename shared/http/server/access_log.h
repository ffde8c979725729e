// One line for each request, written beside serving and never in its way: lines are put into a
// bounded buffer, a thread writes them, and what finds the buffer full is dropped and counted.
//
//   text  192.0.2.1 - - [22/Nov/2026:10:00:00 +0000] "GET /v1/meshes HTTP/1.1" 200 1234 0.000321
//         the common log format, then seconds; and " cut" where not all of the answer was sent
//   json  {"time":"2026-11-22T10:00:00Z","address":"192.0.2.1","method":"GET",
//          "target":"/v1/meshes","status":200,"bytes":1234,"seconds":0.000321,"whole":true}
//
// Times are UTC. Whatever a client sent is escaped, so that no line is forged: in text \xHH for
// quotes, backslashes and all that is no printable ASCII, in JSON \u00HH for the same.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "shared/result.h"

namespace meshfront {

class AccessLog {
 public:
  enum class Format { text, json };

  struct Entry {
    std::string_view address{};
    std::string_view method{};  // both empty where no request came
    std::string_view target{};
    bool version10 = false;  // HTTP/1.0, else 1.1
    unsigned status = 0;
    uint64_t bytes = 0;  // of the answer's content
    double seconds = 0;  // from the request's first line to its end
    bool whole = true;   // the answer was sent to its end
  };

  // `path`: a file to append to, made where there is none, or "-" for standard output.
  [[nodiscard]] static Result<std::unique_ptr<AccessLog>> open(const std::string& path,
                                                               Format format);
  // Writes what is buffered, but gives up after a second.
  ~AccessLog();
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;

  void add(const Entry& entry);
  // Opens the path anew, for a file that was moved away. Keeps the old one where that fails. Lines
  // added before may still go there. May wait for the disk.
  [[nodiscard]] Result<void> reopen();
  [[nodiscard]] uint64_t dropped() const { return dropped_.load(); }  // lines never written

  // A line with its end, as it is written. `time` in seconds since 1970.
  [[nodiscard]] static std::string line(const Entry& entry, Format format, int64_t time);

 private:
  AccessLog(std::string path, Format format, int file)
      : path_(std::move(path)), format_(format), file_(file), thread_([this] { write(); }) {}
  void write();
  void writeOut(const std::string& lines);
  [[nodiscard]] bool waitForRoom(int file);

  static constexpr size_t kMaxBuffered = size_t{1} << 20;

  const std::string path_;
  const Format format_;
  std::atomic<uint64_t> dropped_{0};
  std::mutex fileMutex_;  // held while writing
  int file_;
  std::mutex mutex_;  // of what follows; held for a copy of a line
  std::condition_variable changed_;
  std::string buffer_;
  bool ending_ = false;
  std::atomic<int64_t> giveUp_{INT64_MAX};  // ns of the steady clock
  std::thread thread_;
};

}  // namespace meshfront
