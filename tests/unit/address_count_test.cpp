#include "shared/http/server/address_count.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>

namespace meshfront {
namespace {

ClientAddress addressOf(const char* text) {
  sockaddr_storage storage{};
  if (auto& sixth = reinterpret_cast<sockaddr_in6&>(storage);
      ::inet_pton(AF_INET6, text, &sixth.sin6_addr) == 1) {
    storage.ss_family = AF_INET6;
  } else {
    storage.ss_family = AF_INET;
    EXPECT_EQ(::inet_pton(AF_INET, text, &reinterpret_cast<sockaddr_in&>(storage).sin_addr), 1);
  }
  return ClientAddress(storage);
}

TEST(ClientAddress, IsWrittenAsItIs) {
  for (const char* text : {"192.0.2.1", "2001:db8::1", "::1", "::ffff:192.0.2.1"})
    EXPECT_EQ(addressOf(text).text(), text);
  EXPECT_EQ(ClientAddress().text(), "-");
}

TEST(ClientAddress, CountsByOrigin) {
  const auto same = [](const char* a, const char* b) {
    return addressOf(a).origin() == addressOf(b).origin();
  };
  EXPECT_TRUE(same("2001:db8:1:2::1", "2001:db8:1:2:ffff::"));
  EXPECT_FALSE(same("2001:db8:1:2::1", "2001:db8:1:3::1"));
  EXPECT_FALSE(same("192.0.2.1", "192.0.2.2"));
  EXPECT_TRUE(same("192.0.2.1", "::ffff:192.0.2.1"));
  EXPECT_FALSE(same("0.0.0.0", "::"));
}

TEST(AddressCount, AdmitsUpToTheLimits) {
  AddressCount count({.maxConnections = 4, .maxConnectionsPerAddress = 2});
  const ClientOrigin first = addressOf("192.0.2.1").origin();
  const ClientOrigin second = addressOf("192.0.2.2").origin();
  const ClientOrigin third = addressOf("2001:db8::1").origin();
  EXPECT_EQ(count.open(first), Admission::granted);
  EXPECT_EQ(count.open(first), Admission::granted);
  EXPECT_EQ(count.open(first), Admission::tooManyFromAddress);
  EXPECT_EQ(count.open(first), Admission::tooManyFromAddress);
  EXPECT_EQ(count.open(first), Admission::closedAtOnce);
  count.close(first);
  EXPECT_EQ(count.open(second), Admission::tooMany);
  for (int i = 0; i < 3; ++i) count.close(first);
  EXPECT_EQ(count.open(third), Admission::granted);
  EXPECT_EQ(count.open(first), Admission::granted);
  EXPECT_FALSE(count.full());
  for (int i = 0; i < 4; ++i) static_cast<void>(count.open(third));
  EXPECT_TRUE(count.full());
  count.close(third);
  EXPECT_FALSE(count.full());
}

}  // namespace
}  // namespace meshfront
