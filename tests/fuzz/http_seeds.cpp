#include "tests/fuzz/seeds.h"

namespace meshfront::fuzz {

std::vector<Seed> httpSeeds() {
  std::vector<Seed> seeds;
  const auto add = [&](const char* name, char piece, const std::string& octets) {
    seeds.push_back({"http", name, piece + octets});
  };
  const std::string get =
      "GET /v1/meshes HTTP/1.1\r\nHost: x\r\nIf-None-Match: \"a\", W/\"b\"\r\n\r\n";
  const std::string query =
      "QUERY /v1/meshes/a/0123456789abcdef0123456789abcdef/splits HTTP/1.1\r\nHost: x\r\n"
      "Content-Type: application/octet-stream\r\n";
  const std::string chunked = query + "Transfer-Encoding: chunked\r\n\r\n";
  add("valid-get", 0, get);
  add("valid-pipelined", 6, get + "\r\n" + get + "HEAD http://h/ HTTP/1.0\r\n\r\n");
  add("valid-counted", 40, query + "Content-Length: 3\r\nExpect: 100-continue\r\n\r\nabc" + get);
  add("valid-chunked", 2, chunked + "3\r\nabc\r\n0A;a=b\r\n0123456789\r\n0\r\nA: b\r\n\r\n" + get);
  add("valid-closing", 3, "GET * HTTP/1.1\r\nHost:\r\nConnection: a, close\r\n\r\n");
  add("odd-both", 0, query + "Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n");
  add("odd-lengths", 9, query + "Content-Length: 3\r\nContent-Length: 4\r\n\r\nabcd");
  add("odd-coding", 0, query + "Transfer-Encoding: gzip, chunked\r\n\r\n");
  add("odd-folded", 5, "GET / HTTP/1.1\r\nHost: x\r\n y\r\n\r\n");
  add("odd-colon", 1, "GET / HTTP/1.1\r\nHost : x\r\n\r\n");
  add("odd-bare-cr", 0, "GET /\r HTTP/1.1\r\nHost: x\rA: b\r\n\r\n");
  add("odd-version", 0, "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");
  add("odd-chunk", 7, chunked + "3\r\nabcd\r\n0\r\n\r\n");
  add("odd-size", 7, chunked + "fffffffffffffffff\r\n");
  add("odd-fields", 63, "GET / HTTP/1.1\r\nHost: x\r\nA: " + std::string(1100, 'a'));
  add("odd-after-empty-line", 0, std::string("\r\n\0\0\0", 5));
  add("cut-line", 0, "GET /v1/mes");
  add("cut-chunked", 0, chunked + "3\r\nab");
  return seeds;
}

}  // namespace meshfront::fuzz
