// Contents of requests, byte for byte, cut at every place.
#include "shared/http/server/content_reader.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

constexpr size_t kTrailer = 100;

struct ReadContent {
  std::string content;
  std::string rest;
  bool whole = false;
  unsigned status = 0;
  bool operator==(const ReadContent&) const = default;
};

RequestHead chunkedHead() {
  RequestHead head;
  head.chunked = true;
  return head;
}

ReadContent readContentPieces(const RequestHead& head,
                              std::initializer_list<std::string_view> pieces) {
  ContentReader reader(head, kTrailer);
  ReadContent read;
  for (const std::string_view piece : pieces) {
    const std::string copy(piece);
    std::string_view bytes = copy;
    while (true) {
      const std::string_view found = reader.take(bytes);
      if (found.empty()) break;
      read.content += found;
    }
    if (reader.defect().status == 0) read.rest += bytes;
  }
  read.whole = reader.whole();
  read.status = reader.defect().status;
  if (read.status != 0) read.rest.clear();
  return read;
}

ReadContent readContent(const RequestHead& head, const std::string& text) {
  ReadContent whole = readContentPieces(head, {text});
  for (size_t cut = 0; cut <= text.size(); ++cut)
    EXPECT_EQ(readContentPieces(head, {text.substr(0, cut), text.substr(cut)}), whole)
        << text << " cut at " << cut;
  return whole;
}

TEST(ContentReader, CountsWhatIsAnnounced) {
  RequestHead head;
  EXPECT_TRUE(ContentReader(head, kTrailer).whole());
  head.contentLength = 5;
  EXPECT_EQ(readContent(head, "abcdefg"), (ReadContent{"abcde", "fg", true}));
  EXPECT_EQ(readContent(head, "abcd"), (ReadContent{"abcd", "", false}));
}

TEST(ContentReader, JoinsChunks) {
  const std::string text = "3\r\nabc\r\n0010;a=\"b\"\r\n0123456789abcdef\r\n1 \r\n.\r\n0\r\n";
  const std::string content = "abc0123456789abcdef.";
  EXPECT_EQ(readContent(chunkedHead(), text + "\r\nnext"), (ReadContent{content, "next", true}));
  EXPECT_EQ(readContent(chunkedHead(), text + "A: b\r\nC:\r\n\r\n"),
            (ReadContent{content, "", true}));
  EXPECT_EQ(readContent(chunkedHead(), text), (ReadContent{content, "", false}));
  EXPECT_EQ(readContent(chunkedHead(), "0\r\n\r\n"), (ReadContent{"", "", true}));
  for (size_t size = 0; size < text.size(); ++size) {
    const ReadContent read = readContentPieces(chunkedHead(), {text.substr(0, size)});
    EXPECT_EQ(read.status, 0U) << size;
    EXPECT_FALSE(read.whole);
  }
}

TEST(ContentReader, TakesHexadecimalSizesOfEitherCase) {
  const std::string ten(10, 'x');
  for (const char* size : {"a", "A", "0A", "00000000000000000000000a"})
    EXPECT_EQ(readContent(chunkedHead(), size + ("\r\n" + ten) + "\r\n0\r\n\r\n").content, ten);
}

TEST(ContentReader, RefusesUnsoundChunks) {
  for (const char* text :
       {"\r\n", "g\r\n", "-1\r\n", "+1\r\n", "0x1\r\n", " 1\r\n", "1\n", "1\r\nab\r\n", "1\r\na\n",
        "1\r\na0\r\n\r\n", "1 1\r\n", "1\ra\r\n", "1;\x01\r\n", "10000000000000000\r\n",
        "0\r\nA : b\r\n", "0\r\n A: b\r\n", "0\r\nA\r\n", "0\r\n\n"})
    EXPECT_EQ(readContent(chunkedHead(), text).status, 400U) << text;
}

TEST(ContentReader, BoundsLines) {
  EXPECT_EQ(readContent(chunkedHead(), "1;" + std::string(2000, 'a')).status, 400U);
  EXPECT_EQ(readContent(chunkedHead(), "0\r\nA: " + std::string(kTrailer, 'a')).status, 431U);
}

}  // namespace
}  // namespace meshfront
