// Requests' lines and fields, byte for byte, cut at every place.
#include "shared/http/server/request_head.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

using HeadState = RequestHeadReader::State;

constexpr size_t kFields = 1000;

struct ReadHead {
  HeadState state = HeadState::line;
  unsigned status = 0;
  RequestHead head;
  std::string rest;
};

ReadHead readPieces(std::initializer_list<std::string_view> pieces) {
  RequestHeadReader reader(kFields);
  ReadHead read;
  for (const std::string_view piece : pieces) {
    const std::string copy(piece);  // of the exact size, gone afterwards
    std::string_view bytes = copy;
    reader.take(bytes);
    read.rest += bytes;
  }
  read.state = reader.state();
  read.status = reader.defect().status;
  read.head = reader.head();
  return read;
}

std::string summary(const ReadHead& read) {
  const RequestHead& head = read.head;
  return std::to_string(static_cast<int>(read.state)) + " " + std::to_string(read.status) + " " +
         head.method + " " + head.target + " [" + head.ifNoneMatch + "] [" + head.contentType +
         "] " + std::to_string(head.contentLength) + (head.chunked ? " chunked" : "") +
         (head.keepAlive ? " keep" : " close") + (head.expectsContinue ? " expects" : "") +
         (head.version10 ? " 1.0" : " 1.1");
}

// In one piece, in two of every size, octet by octet: always the same.
ReadHead readHead(const std::string& text) {
  ReadHead whole = readPieces({text});
  for (size_t cut = 0; cut <= text.size(); ++cut) {
    const ReadHead cutRead = readPieces({text.substr(0, cut), text.substr(cut)});
    EXPECT_EQ(summary(cutRead), summary(whole)) << text << " cut at " << cut;
    if (whole.state == HeadState::whole) {
      EXPECT_EQ(cutRead.rest, whole.rest) << cut;
    }
  }
  return whole;
}

unsigned refusalOf(const std::string& text) {
  const ReadHead read = readHead(text);
  EXPECT_EQ(read.state, HeadState::defective) << text;
  return read.status;
}

const std::string kLine = "GET / HTTP/1.1\r\n";
const std::string kHost = "Host: x\r\n";

TEST(RequestHead, IsRead) {
  const ReadHead read = readHead(
      "QUERY /a%41?b&c HTTP/1.1\r\nhost:x\r\nIF-NONE-MATCH: \"a\"\r\nContent-Type:\t a/b \r\n"
      "If-None-Match: W/\"b\"\r\nContent-Length: 12\r\nExpect: "
      "100-Continue\r\nX:\r\n\r\nfollowing");
  EXPECT_EQ(summary(read), std::to_string(static_cast<int>(HeadState::whole)) +
                               " 0 QUERY /a%41?b&c [\"a\", W/\"b\"] [a/b] 12 keep expects 1.1");
  EXPECT_EQ(read.rest, "following");
  EXPECT_TRUE(read.head.announcesContent());
}

TEST(RequestHead, CutShortWaitsForMore) {
  const std::string text = kLine + kHost + "A: b\r\n\r\n";
  for (size_t size = 0; size < text.size(); ++size) {
    const ReadHead read = readPieces({text.substr(0, size)});
    EXPECT_EQ(read.state, size < kLine.size() ? HeadState::line : HeadState::fields) << size;
    EXPECT_EQ(read.rest, "");
  }
  EXPECT_EQ(readHead(text).state, HeadState::whole);
}

TEST(RequestHead, MayFollowOneEmptyLine) {
  EXPECT_EQ(readHead("\r\n" + kLine + kHost + "\r\n").state, HeadState::whole);
  EXPECT_EQ(refusalOf("\r\n\r\n" + kLine + kHost + "\r\n"), 400U);
  EXPECT_EQ(refusalOf(std::string("\r\n\0", 3)), 400U);  // before the line's end
}

TEST(RequestHead, SaysWhetherTheConnectionIsKept) {
  const auto kept = [](const std::string& version, const std::string& fields) {
    const ReadHead read = readHead("GET / HTTP/" + version + "\r\n" + kHost + fields + "\r\n");
    EXPECT_EQ(read.state, HeadState::whole);
    return read.head.keepAlive;
  };
  EXPECT_TRUE(kept("1.1", ""));
  EXPECT_TRUE(kept("1.7", ""));
  EXPECT_FALSE(kept("1.1", "Connection: close\r\n"));
  EXPECT_FALSE(kept("1.1", "Connection: keep-alive, CLOSE\r\n"));
  EXPECT_FALSE(kept("1.0", ""));
  EXPECT_TRUE(kept("1.0", "Connection: TE,Keep-Alive\r\n"));
  EXPECT_FALSE(kept("1.0", "Connection: keep-alive\r\nConnection: close\r\n"));
}

TEST(RequestHead, OfHttp10NeedsNoHost) {
  const ReadHead read = readHead("GET / HTTP/1.0\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(read.state, HeadState::whole);
  EXPECT_FALSE(read.head.expectsContinue);
}

TEST(RequestHead, KeepsOctetsOfTargetsAsTheyAre) {
  EXPECT_EQ(readHead("GET /\"\\\xFF# HTTP/1.1\r\n" + kHost + "\r\n").head.target, "/\"\\\xFF#");
  EXPECT_EQ(readHead("OPTIONS * HTTP/1.1\r\n" + kHost + "\r\n").head.target, "*");
}

TEST(RequestHead, LinesMustBeSound) {
  for (const char* line : {"GET /\r\n",
                           "GET / \r\n",
                           "GET  / HTTP/1.1\r\n",
                           "GET /  HTTP/1.1\r\n",
                           "GET / HTTP/1.1 \r\n",
                           "GET /a b HTTP/1.1\r\n",
                           "GET /a\tb HTTP/1.1\r\n",
                           "GET /\x01 HTTP/1.1\r\n",
                           "GET /\x7F HTTP/1.1\r\n",
                           "GET /\r HTTP/1.1\r\n",
                           "GET / HTTP/1.1\n",
                           "GET / HTTP/1.1\r\r\n",
                           "GET / http/1.1\r\n",
                           "GET / HTTP/1\r\n",
                           "GET / HTTP/1.10\r\n",
                           "GET / HTTP/a.b\r\n",
                           "G(T / HTTP/1.1\r\n",
                           "GET\r\n",
                           " GET / HTTP/1.1\r\n",
                           "\n",
                           "\x16\x03\x01"})
    EXPECT_EQ(refusalOf(line), 400U) << line;
  EXPECT_EQ(refusalOf(std::string("GET /\0 HTTP/1.1\r\n", 17)), 400U);
  EXPECT_EQ(refusalOf(std::string(65, 'A') + " / HTTP/1.1\r\n"), 400U);
}

TEST(RequestHead, OfAnotherVersionIsRefused) {
  EXPECT_EQ(refusalOf("GET / HTTP/2.0\r\n"), 505U);
  EXPECT_EQ(refusalOf("PRI * HTTP/2.0\r\n"), 505U);
  EXPECT_EQ(refusalOf("GET / HTTP/0.9\r\n"), 505U);
}

TEST(RequestHead, FieldsMustBeSound) {
  for (const char* field : {"A : b\r\n", "A\t: b\r\n", ": b\r\n", "A b\r\n", " A: b\r\n",
                            "A: b\r\n folded\r\n", "A: b\r\n\tfolded\r\n", "A: b\n", "A: b\rc\r\n",
                            "A: \x01\r\n", "A: \x7F\r\n", "A(: b\r\n", "A: b\r\n\n"})
    EXPECT_EQ(refusalOf(kLine + kHost + field), 400U) << field;
  EXPECT_EQ(refusalOf(kLine + kHost + std::string("A: \0\r\n", 6)), 400U);
}

TEST(RequestHead, OneMeaningOfItsLength) {
  const auto refused = [](const std::string& fields) {
    return refusalOf("QUERY / HTTP/1.1\r\n" + kHost + fields + "\r\n");
  };
  const std::string one = "Content-Length: 1\r\n";
  const std::string chunked = "Transfer-Encoding: chunked\r\n";
  EXPECT_EQ(refused(one + one), 400U);
  EXPECT_EQ(refused(one + "Content-Length: 2\r\n"), 400U);
  EXPECT_EQ(refused(one + chunked), 400U);
  EXPECT_EQ(refused(chunked + one), 400U);
  EXPECT_EQ(refused(chunked + chunked), 400U);
  for (const char* length : {"", "+1", "-1", "1 1", "1,1", "0x1", "1.0", "a"})
    EXPECT_EQ(refused(std::string("Content-Length: ") + length + "\r\n"), 400U) << length;
  for (const char* coding :
       {"", "gzip", "gzip, chunked", "chunked, chunked", "identity", "xchunked"})
    EXPECT_EQ(refused(std::string("Transfer-Encoding: ") + coding + "\r\n"), 501U) << coding;
  EXPECT_EQ(refusalOf("QUERY / HTTP/1.0\r\n" + chunked + "\r\n"), 400U);
  EXPECT_EQ(refused("Host: y\r\n"), 400U);
  EXPECT_EQ(refusalOf(kLine + "\r\n"), 400U);
}

TEST(RequestHead, LengthsMayBeAnyNumber) {
  const auto length = [](const std::string& text) {
    return readHead("QUERY / HTTP/1.1\r\n" + kHost + "Content-Length: " + text + "\r\n\r\n")
        .head.contentLength;
  };
  EXPECT_EQ(length("0"), 0U);
  EXPECT_EQ(length("007"), 7U);
  EXPECT_EQ(length("18446744073709551614"), UINT64_MAX - 1);
  EXPECT_EQ(length(std::string(400, '9')), UINT64_MAX);
}

TEST(RequestHead, LongLinesAreRefusedAsSoonAsTheyAreTooLong) {
  const std::string longest = "GET /" + std::string(kMaxRequestLine - 16, 'a') + " HTTP/1.1\r\n";
  ASSERT_EQ(longest.size(), kMaxRequestLine);
  EXPECT_EQ(readPieces({longest, kHost, "\r\n"}).state, HeadState::whole);
  EXPECT_EQ(readPieces({"GET /a", longest.substr(5)}).status, 414U);
  const std::string endless(kMaxRequestLine, 'a');
  EXPECT_EQ(readPieces({"GET /", endless.substr(5)}).state, HeadState::line);
  const ReadHead refused = readPieces({"GET /", endless, endless});
  EXPECT_EQ(refused.status, 414U);
  EXPECT_EQ(refused.head.method, "GET");
  EXPECT_LT(refused.head.target.size(), 100U);
  EXPECT_EQ(readPieces({endless, endless}).status, 400U);
}

TEST(RequestHead, LongFieldsAreRefusedAsSoonAsTheyAreTooLong) {
  const std::string fits(kFields - kHost.size() - 7, 'b');
  EXPECT_EQ(readHead(kLine + kHost + "A: " + fits + "\r\n\r\n").state, HeadState::whole);
  EXPECT_EQ(refusalOf(kLine + kHost + "A: " + fits + "b\r\n\r\n"), 431U);
  EXPECT_EQ(refusalOf(kLine + std::string(kFields + 1, 'b')), 431U);
  std::string many;
  while (many.size() <= kFields) many += "A: b\r\n";
  EXPECT_EQ(refusalOf(kLine + kHost + many), 431U);
}

}  // namespace
}  // namespace meshfront
