#include "shared/mesh_files/decompress.h"

#include <gtest/gtest.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include <fstream>

#include "shared/mesh_files/available_memory.h"
#include "shared/mesh_files/mesh_files.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

constexpr uint64_t kLimit = uint64_t{1} << 30;
const std::vector<Compression> kAll = {Compression::gzip, Compression::xz, Compression::zstd};

std::string compress(const std::string& text, Compression compression) {
  std::string out(text.size() + 1024, '\0');
  auto* to = reinterpret_cast<uint8_t*>(out.data());
  const auto* from = reinterpret_cast<const uint8_t*>(text.data());
  size_t size = 0;
  if (compression == Compression::gzip) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = const_cast<Bytef*>(from);
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = to;
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    size = stream.total_out;
    deflateEnd(&stream);
  } else if (compression == Compression::xz) {
    EXPECT_EQ(lzma_easy_buffer_encode(1, LZMA_CHECK_CRC64, nullptr, from, text.size(), to, &size,
                                      out.size()),
              LZMA_OK);
  } else {
    // With a checksum, so that every damage is noticed.
    ZSTD_CCtx* context = ZSTD_createCCtx();
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    size = ZSTD_compress2(context, to, out.size(), from, text.size());
    ZSTD_freeCCtx(context);
  }
  out.resize(size);
  return out;
}

std::string sample(size_t length) {
  std::string text;
  for (uint32_t i = 1; text.size() < length; i = i * 1664525 + 1013904223)
    text += "v " + std::to_string(i >> 8) + "\n";
  text.resize(length);
  return text;
}

std::string decompressed(const std::string& bytes) {
  auto out = decompress(bytes, compressionOf(bytes), kLimit);
  EXPECT_TRUE(out) << out.error().message;
  return out ? *out : std::string();
}

TEST(Decompress, GivesBackWhatWasCompressed) {
  for (const Compression compression : kAll) {
    for (const size_t length : {0, 1, 65535, 65536, 65537, 500000}) {
      const std::string text = sample(length);
      const std::string bytes = compress(text, compression);
      EXPECT_EQ(compressionOf(bytes), compression);
      EXPECT_EQ(decompressed(bytes), text) << nameOf(compression) << " " << length;
      EXPECT_EQ(decompressed(bytes + bytes), text + text) << nameOf(compression) << " " << length;
    }
  }
  EXPECT_EQ(decompressed("plain"), "plain");
}

TEST(Decompress, NoticesEveryTruncationAndChangedByte) {
  const std::string text = sample(500);
  for (const Compression compression : kAll) {
    SCOPED_TRACE(nameOf(compression));
    const std::string bytes = compress(text, compression);
    for (size_t length = 0; length < bytes.size(); ++length) {
      const std::vector<char> prefix(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(length));
      const auto out = decompress({prefix.data(), prefix.size()}, compression, kLimit);
      ASSERT_FALSE(out && !(length == 0 && out->empty())) << length;
    }
    for (size_t i = 0; i < bytes.size(); ++i) {
      std::string changed = bytes;
      changed[i] = static_cast<char>(changed[i] ^ 0x10);
      const auto out = decompress(changed, compression, kLimit);
      if (out) {  // a field that says nothing, as gzip's time
        EXPECT_EQ(*out, text) << i;
      }
    }
    EXPECT_FALSE(decompress(bytes + "rubbish behind it", compression, kLimit));
  }
  EXPECT_EQ(decompressed(compress(text, Compression::gzip) + std::string(7, '\0')), text);
  const auto cut =
      decompress(compress(text, Compression::xz).substr(0, 100), Compression::xz, kLimit);
  EXPECT_EQ(cut.error().message, "byte 100 of the xz file: it ends early");
}

TEST(Decompress, StopsAtTheLimit) {
  const std::string zeros(5000000, '\0');
  for (const Compression compression : kAll) {
    const std::string bytes = compress(zeros, compression);
    EXPECT_LT(bytes.size(), 100000U);
    const auto out = decompress(bytes, compression, 1000000);
    ASSERT_FALSE(out);
    EXPECT_EQ(out.error().code, ErrorCode::tooLarge);
    const std::string text = sample(1000);
    EXPECT_FALSE(decompress(compress(text, compression), compression, 999));
    EXPECT_TRUE(decompress(compress(text, compression), compression, 1000));
  }
}

TEST(CompressedMeshFiles, AreReadWhateverTheyAreCalled) {
  const TemporaryFolder folder;
  const auto put = [&](const std::string& name, const std::string& content) {
    std::ofstream(folder / name, std::ios::binary) << content;
    return folder / name;
  };
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto triangles = [](const std::filesystem::path& path) {
    const auto mesh = readMesh(path);
    EXPECT_TRUE(mesh) << mesh.error().message;
    return mesh ? mesh->triangles.size() : 0;
  };
  EXPECT_EQ(triangles(put("a.obj.gz", compress(obj, Compression::gzip))), 1U);
  EXPECT_EQ(triangles(put("a.OBJ.XZ", compress(obj, Compression::xz))), 1U);
  EXPECT_EQ(triangles(put("a.obj.zst", compress(obj, Compression::zstd))), 1U);
  EXPECT_EQ(triangles(put("nothing.gz", compress(obj, Compression::gzip))), 1U);
  EXPECT_EQ(triangles(put("a.obj", compress(obj, Compression::xz))), 1U);
  EXPECT_EQ(triangles(put("wrong.gz", compress(obj, Compression::zstd))), 1U);
  EXPECT_EQ(triangles(put("b.obj.gz", obj)), 1U);  // somebody decompressed it on the way

  const auto problem = [&](const std::filesystem::path& path) {
    const auto mesh = readMesh(path);
    return mesh ? "none" : mesh.error().message.substr(folder.path().string().size() + 1);
  };
  EXPECT_EQ(problem(put("cut.ply.gz", compress(obj, Compression::gzip).substr(0, 30))),
            "cut.ply.gz: byte 30 of the gzip file: it ends early");
  EXPECT_EQ(problem(put("c.ply.gz", "hello")), "c.ply.gz: byte 0: neither a gzip file nor a mesh");
  EXPECT_EQ(problem(put("d.ply.xz", compress(obj, Compression::xz))),
            "d.ply.xz: line 1: a PLY file starts with the line 'ply'");
  EXPECT_EQ(problem(put("e.xz", compress("hello", Compression::xz))).substr(0, 29),
            "e.xz: byte 0: not a mesh file");
}

TEST(AvailableMemory, IsSomething) {
  EXPECT_GT(availableMemory().bytes, uint64_t{1} << 20);
}

}  // namespace
}  // namespace meshfront
