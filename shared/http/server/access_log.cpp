#include "shared/http/server/access_log.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>

namespace meshfront {
namespace {

constexpr std::chrono::milliseconds kPause(200);  // between two writes
constexpr size_t kManyLines = size_t{64} << 10;   // octets that are not left waiting

int64_t steadyNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void appendEscaped(std::string& out, std::string_view text, const char* prefix) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (const char c : text) {
    const auto octet = static_cast<uint8_t>(c);
    if (octet >= 0x20 && octet < 0x7F && c != '"' && c != '\\') {
      out.push_back(c);
    } else {
      out += prefix;
      out.push_back(kDigits[octet >> 4]);
      out.push_back(kDigits[octet & 15]);
    }
  }
}

// Made once a second and thread, since many lines have the same.
const std::string& timeText(int64_t time, const char* format) {
  thread_local std::string text;
  thread_local int64_t textTime = -1;
  thread_local const char* textFormat = nullptr;
  if (time == textTime && format == textFormat) return text;
  const auto seconds = static_cast<time_t>(time);
  tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 64> buffer{};
  text.assign(buffer.data(), std::strftime(buffer.data(), buffer.size(), format, &parts));
  textTime = time;
  textFormat = format;
  return text;
}

std::string secondsText(double seconds) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.6f", seconds);
  return {text.data(), static_cast<size_t>(std::clamp(length, 0, 31))};
}

std::string textLine(const AccessLog::Entry& entry, int64_t time) {
  static constexpr const char* kTime = " - - [%d/%b/%Y:%H:%M:%S +0000] \"";
  std::string line;
  line.reserve(entry.target.size() + 128);
  line.append(entry.address).append(timeText(time, kTime));
  if (entry.method.empty()) {
    line += "-";
  } else {
    appendEscaped(line, entry.method, "\\x");
    line += " ";
    appendEscaped(line, entry.target, "\\x");
    line += entry.version10 ? " HTTP/1.0" : " HTTP/1.1";
  }
  line += "\" " + std::to_string(entry.status) + " " + std::to_string(entry.bytes) + " " +
          secondsText(entry.seconds);
  return line + (entry.whole ? "\n" : " cut\n");
}

std::string jsonLine(const AccessLog::Entry& entry, int64_t time) {
  static constexpr const char* kTime = "{\"time\":\"%Y-%m-%dT%H:%M:%SZ\",\"address\":\"";
  std::string line;
  line.reserve(entry.target.size() + 256);
  line.append(timeText(time, kTime)).append(entry.address).append("\",\"method\":\"");
  appendEscaped(line, entry.method, "\\u00");
  line += "\",\"target\":\"";
  appendEscaped(line, entry.target, "\\u00");
  line += "\",\"status\":" + std::to_string(entry.status) +
          ",\"bytes\":" + std::to_string(entry.bytes) +
          ",\"seconds\":" + secondsText(entry.seconds);
  return line + (entry.whole ? ",\"whole\":true}\n" : ",\"whole\":false}\n");
}

Result<int> openLog(const std::string& path) {
  if (path == "-") {
    const int copy = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    if (copy < 0) return fail(ErrorCode::unavailable, "access log: there is no standard output");
    return copy;
  }
  constexpr mode_t kReadableByGroup = 0640;
  const int file =
      ::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kReadableByGroup);
  if (file < 0)
    return fail(ErrorCode::unavailable,
                "access log " + path + ": cannot be opened: " + std::strerror(errno));
  return file;
}

size_t linesIn(std::string_view text) {
  return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

std::string AccessLog::line(const Entry& entry, Format format, int64_t time) {
  return format == Format::json ? jsonLine(entry, time) : textLine(entry, time);
}

Result<std::unique_ptr<AccessLog>> AccessLog::open(const std::string& path, Format format) {
  const auto file = openLog(path);
  if (!file) return tl::unexpected(file.error());
  return std::unique_ptr<AccessLog>(new AccessLog(path, format, *file));
}

AccessLog::~AccessLog() {
  giveUp_ = steadyNanoseconds() + 1'000'000'000;
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
  ::close(file_);
}

Result<void> AccessLog::reopen() {
  if (path_ == "-") return {};
  const auto file = openLog(path_);
  if (!file) return tl::unexpected(file.error());
  const std::scoped_lock lock(fileMutex_);
  ::close(file_);
  file_ = *file;
  return {};
}

void AccessLog::add(const Entry& entry) {
  const std::string text = line(entry, format_, std::time(nullptr));
  bool many = false;
  {
    const std::scoped_lock lock(mutex_);
    if (buffer_.size() + text.size() > kMaxBuffered) {
      ++dropped_;
      return;
    }
    many = buffer_.size() < kManyLines && buffer_.size() + text.size() >= kManyLines;
    buffer_ += text;
  }
  if (many) changed_.notify_one();
}

void AccessLog::write() {
  std::string lines;
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait_for(lock, kPause, [this] { return ending_ || buffer_.size() >= kManyLines; });
    const bool last = ending_;
    lines.swap(buffer_);
    lock.unlock();
    writeOut(lines);
    lines.clear();
    if (last) return;
    lock.lock();
  }
}

// A reader that takes nothing for a second loses lines: reopening and ending wait for this.
bool AccessLog::waitForRoom(int file) {
  constexpr int kPiece = 100;  // ms
  for (int waited = 0; waited < 1000 && steadyNanoseconds() < giveUp_.load(); waited += kPiece) {
    pollfd room{file, POLLOUT, 0};
    if (::poll(&room, 1, kPiece) > 0) return (room.revents & (POLLERR | POLLNVAL)) == 0;
  }
  return false;
}

void AccessLog::writeOut(const std::string& lines) {
  const std::scoped_lock lock(fileMutex_);
  struct stat status {};
  const bool isFile = ::fstat(file_, &status) == 0 && S_ISREG(status.st_mode);
  // A pipe that has room takes so many octets without making the writer wait.
  constexpr size_t kPipePiece = 4096;
  std::string_view rest = lines;
  while (!rest.empty()) {
    if (!isFile && !waitForRoom(file_)) break;
    const ssize_t written =
        ::write(file_, rest.data(), isFile ? rest.size() : std::min(rest.size(), kPipePiece));
    if (written < 0 && errno != EINTR && errno != EAGAIN) break;
    if (written > 0) rest.remove_prefix(static_cast<size_t>(written));
  }
  dropped_ += linesIn(rest);
}

}  // namespace meshfront
