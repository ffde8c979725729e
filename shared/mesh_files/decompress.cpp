#include "shared/mesh_files/decompress.h"

#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "shared/mesh_files/file_extension.h"

namespace meshfront {
namespace {

constexpr size_t kFirstStep = size_t{1} << 16;
constexpr size_t kLargestStep = size_t{1} << 24;
constexpr uint64_t kXzMemory = uint64_t{256} << 20;  // xz -9 needs 65 MiB

// The output, which grows as it fills and never beyond the limit.
class BoundedOutput {
 public:
  explicit BoundedOutput(uint64_t limit) : limit_(limit) {}

  // Room for some more bytes; none if the limit is reached.
  [[nodiscard]] bool makeRoom() {
    const uint64_t step =
        std::min<uint64_t>(std::clamp(filled_, kFirstStep, kLargestStep), limit_ - filled_);
    bytes_.resize(filled_ + step);
    return step > 0;
  }
  [[nodiscard]] char* room() { return bytes_.data() + filled_; }
  [[nodiscard]] size_t roomSize() const { return bytes_.size() - filled_; }
  void fill(size_t count) { filled_ += count; }
  [[nodiscard]] std::string take() {
    bytes_.resize(filled_);
    return std::move(bytes_);
  }
  [[nodiscard]] tl::unexpected<Error> tooLarge() const {
    return fail(ErrorCode::tooLarge, "decompressed it is larger than " + std::to_string(limit_) +
                                         " bytes, which is the limit or all the memory there is");
  }

 private:
  std::string bytes_;
  size_t filled_ = 0;
  uint64_t limit_;
};

tl::unexpected<Error> damaged(size_t byte, const char* format, const std::string& what) {
  return fail("byte " + std::to_string(byte) + " of the " + format + " file: " + what);
}

// Each step of a decoder: from the rest of the input into the room there is.
struct Step {
  enum class End { goesOn, ended, broken } end = End::goesOn;
  std::string why;  // if broken
};

// Feeds a decoder until it ends. Its step(input, out, room, produced) shortens the input by what it
// took and says how many bytes it put to `out`.
template <typename Decoder>
Result<std::string> decodeAll(Decoder decoder, std::string_view file, const char* format,
                              uint64_t limit) {
  BoundedOutput output(limit);
  std::string_view input = file;
  while (true) {
    const bool room = output.roomSize() > 0 || output.makeRoom();
    char spare = 0;  // at the limit one byte more tells whether there is more
    const size_t before = input.size();
    size_t produced = 0;
    const Step step =
        decoder.step(input, room ? output.room() : &spare, room ? output.roomSize() : 1, produced);
    if (!room && produced > 0) return output.tooLarge();
    output.fill(produced);
    if (step.end == Step::End::broken) return damaged(file.size() - input.size(), format, step.why);
    if (step.end == Step::End::ended) return output.take();
    if (input.size() == before && produced == 0)
      return damaged(file.size(), format, "it ends early");
  }
}

class GzipDecoder {
 public:
  GzipDecoder() : stream_(new z_stream{}) {
    ready_ = inflateInit2(stream_.get(), 16 + MAX_WBITS) == Z_OK;
  }
  Step step(std::string_view& input, char* out, size_t room, size_t& produced) {
    if (!ready_) return {Step::End::broken, "no memory to decompress it"};
    if (betweenMembers_ && members_ > 0) {
      // Padding behind the last member is allowed, and nothing else but another member.
      const size_t content = input.find_first_not_of('\0');
      if (content == input.npos) return {Step::End::ended, {}};
      if (content > 0 || !input.starts_with("\x1f\x8b"))
        return {Step::End::broken, "something else follows the compressed data"};
    }
    betweenMembers_ = false;
    constexpr size_t kMost = size_t{1} << 30;  // zlib counts in 32 bits
    stream_->next_in = reinterpret_cast<Bytef*>(const_cast<char*>(input.data()));
    stream_->avail_in = static_cast<uInt>(std::min(input.size(), kMost));
    stream_->next_out = reinterpret_cast<Bytef*>(out);
    stream_->avail_out = static_cast<uInt>(std::min(room, kMost));
    const uInt inBefore = stream_->avail_in;
    const uInt outBefore = stream_->avail_out;
    const int status = inflate(stream_.get(), Z_NO_FLUSH);
    input.remove_prefix(inBefore - stream_->avail_in);
    produced = outBefore - stream_->avail_out;
    if (status == Z_STREAM_END) {
      ++members_;
      betweenMembers_ = true;
      inflateReset(stream_.get());
      return {};
    }
    if (status == Z_OK || status == Z_BUF_ERROR) return {};
    return {Step::End::broken,
            std::string("damaged") +
                (stream_->msg == nullptr ? "" : " (" + std::string(stream_->msg) + ")")};
  }

 private:
  struct End {
    void operator()(z_stream* stream) const {
      inflateEnd(stream);
      delete stream;
    }
  };
  std::unique_ptr<z_stream, End> stream_;
  bool ready_ = false;
  bool betweenMembers_ = true;
  uint64_t members_ = 0;
};

class XzDecoder {
 public:
  XzDecoder() : stream_(new lzma_stream(LZMA_STREAM_INIT)) {
    ready_ = lzma_stream_decoder(stream_.get(), kXzMemory, LZMA_CONCATENATED) == LZMA_OK;
  }
  Step step(std::string_view& input, char* out, size_t room, size_t& produced) {
    if (!ready_) return {Step::End::broken, "no memory to decompress it"};
    stream_->next_in = reinterpret_cast<const uint8_t*>(input.data());
    stream_->avail_in = input.size();
    stream_->next_out = reinterpret_cast<uint8_t*>(out);
    stream_->avail_out = room;
    const lzma_ret status = lzma_code(stream_.get(), LZMA_FINISH);
    input.remove_prefix(input.size() - stream_->avail_in);
    produced = room - stream_->avail_out;
    switch (status) {
      case LZMA_OK:
      case LZMA_BUF_ERROR:
        return {};
      case LZMA_STREAM_END:
        return {Step::End::ended, {}};
      case LZMA_MEMLIMIT_ERROR:
        return {Step::End::broken, "it takes more than 256 MiB to decompress"};
      default:
        return {Step::End::broken, "damaged"};
    }
  }

 private:
  struct End {
    void operator()(lzma_stream* stream) const {
      lzma_end(stream);
      delete stream;
    }
  };
  std::unique_ptr<lzma_stream, End> stream_;
  bool ready_ = false;
};

class ZstdDecoder {
 public:
  ZstdDecoder() : stream_(ZSTD_createDStream()) {}
  Step step(std::string_view& input, char* out, size_t room, size_t& produced) {
    if (stream_ == nullptr) return {Step::End::broken, "no memory to decompress it"};
    if (input.empty() && betweenFrames_) return {Step::End::ended, {}};
    ZSTD_inBuffer in{input.data(), input.size(), 0};
    ZSTD_outBuffer space{out, room, 0};
    const size_t status = ZSTD_decompressStream(stream_.get(), &space, &in);
    input.remove_prefix(in.pos);
    produced = space.pos;
    if (ZSTD_isError(status) != 0)
      return {Step::End::broken, std::string("damaged (") + ZSTD_getErrorName(status) + ")"};
    betweenFrames_ = status == 0;
    return {};
  }

 private:
  struct End {
    void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
  };
  std::unique_ptr<ZSTD_DStream, End> stream_;
  bool betweenFrames_ = false;
};

}  // namespace

Compression compressionOf(std::string_view file) {
  using namespace std::string_view_literals;
  if (file.starts_with("\x1f\x8b"sv)) return Compression::gzip;
  if (file.starts_with("\xfd\x37zXZ\0"sv)) return Compression::xz;
  if (file.starts_with("\x28\xb5\x2f\xfd"sv)) return Compression::zstd;
  return Compression::none;
}

Compression compressionNamed(const std::filesystem::path& path) {
  const std::string extension = lowerCaseExtension(path);
  if (extension == ".gz") return Compression::gzip;
  if (extension == ".xz") return Compression::xz;
  return extension == ".zst" ? Compression::zstd : Compression::none;
}

const char* nameOf(Compression compression) {
  switch (compression) {
    case Compression::gzip:
      return "gzip";
    case Compression::xz:
      return "xz";
    case Compression::zstd:
      return "zstd";
    case Compression::none:
      break;
  }
  return "uncompressed";
}

Result<std::string> decompress(std::string_view file, Compression compression, uint64_t limit) {
  switch (compression) {
    case Compression::gzip:
      return decodeAll(GzipDecoder(), file, nameOf(compression), limit);
    case Compression::xz:
      return decodeAll(XzDecoder(), file, nameOf(compression), limit);
    case Compression::zstd:
      return decodeAll(ZstdDecoder(), file, nameOf(compression), limit);
    case Compression::none:
      break;
  }
  return std::string(file);
}

}  // namespace meshfront
