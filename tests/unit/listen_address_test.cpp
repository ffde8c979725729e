#include "shared/http/server/listen_address.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(ListenAddress, ReadsHostAndPort) {
  const auto v4 = resolveListenAddress("127.0.0.1:8080");
  ASSERT_TRUE(v4) << v4.error().message;
  EXPECT_EQ(v4->host, "127.0.0.1");
  EXPECT_EQ(v4->port, 8080);
  EXPECT_EQ(v4->socketAddress.ss_family, AF_INET);
  const auto v6 = resolveListenAddress("[::1]:0");
  ASSERT_TRUE(v6) << v6.error().message;
  EXPECT_EQ(v6->host, "[::1]");
  EXPECT_EQ(v6->port, 0);
  EXPECT_EQ(v6->socketAddress.ss_family, AF_INET6);
}

TEST(ListenAddress, RefusesOtherText) {
  for (const char* text : {"", ":80", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "::1:80",
                           "127.0.0.1:8o", "127.0.0.1:-1", "[::1]", "localhost:http"})
    EXPECT_FALSE(resolveListenAddress(text)) << text;
}

}  // namespace
}  // namespace meshfront
