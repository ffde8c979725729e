#include "shared/receiver/mesh_url.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(MeshUrl, TakesApartWhatAServicePublishes) {
  const auto url = parseMeshUrl("http://127.0.0.1:8080/v1/meshes/bunny");
  ASSERT_TRUE(url) << url.error().message;
  EXPECT_EQ(url->origin, "http://127.0.0.1:8080");
  EXPECT_EQ(url->prefix, "");
  EXPECT_EQ(url->name, "bunny");
  EXPECT_EQ(url->metadata(), "http://127.0.0.1:8080/v1/meshes/bunny");
  EXPECT_EQ(url->base("cafe"), "http://127.0.0.1:8080/v1/meshes/bunny/cafe/base");
  EXPECT_EQ(url->splits("cafe", "AAE", ""),
            "http://127.0.0.1:8080/v1/meshes/bunny/cafe/splits/AAE");
  EXPECT_EQ(url->splits("cafe", "AAE", "levels=2"),
            "http://127.0.0.1:8080/v1/meshes/bunny/cafe/splits/AAE?levels=2");
  EXPECT_EQ(url->splitsQuery("cafe", "significance=3"),
            "http://127.0.0.1:8080/v1/meshes/bunny/cafe/splits?significance=3");
}

TEST(MeshUrl, TakesHostsOfEveryKind) {
  for (const char* text :
       {"https://meshes.example.org/v1/meshes/igea", "http://[::1]:8080/v1/meshes/a.b_c-d",
        "http://localhost/v1/meshes/x/", "http://[2001:db8::1]/v1/meshes/x"}) {
    EXPECT_TRUE(parseMeshUrl(text)) << text;
  }
  const auto behind = parseMeshUrl("https://host/some/where/v1/meshes/x");
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->prefix, "/some/where");
  EXPECT_EQ(behind->metadata(), "https://host/some/where/v1/meshes/x");
}

TEST(MeshUrl, SaysWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "no scheme"},
      {"localhost:8080/v1/meshes/x", "no scheme"},
      {"ftp://host/v1/meshes/x", "'ftp'"},
      {"http:///v1/meshes/x", "no host"},
      {"http://host:0/v1/meshes/x", "port"},
      {"http://host:65536/v1/meshes/x", "port"},
      {"http://host:80a/v1/meshes/x", "port"},
      {"http://[::1/v1/meshes/x", "bracket"},
      {"http://[::g]/v1/meshes/x", "IPv6"},
      {"http://ho st/v1/meshes/x", "host name"},
      {"http://me:secret@host/v1/meshes/x", "credentials"},
      {"http://host", "names no mesh"},
      {"http://host/v1/meshes", "names no mesh"},
      {"http://host/v2/meshes/x", "'v2'"},
      {"http://host/meshes/x", "version"},
      {"http://host/v1/meshes/.x", "mesh name"},
      {"http://host/v1/meshes/a/b", "mesh name"},
      {"http://host/v1/meshes/x?y", "query"},
      {"http://host/a b/v1/meshes/x", "escaped"},
  };
  for (const auto& [text, expected] : cases) {
    const auto url = parseMeshUrl(text);
    ASSERT_FALSE(url) << text;
    EXPECT_NE(url.error().message.find(expected), std::string::npos) << url.error().message;
    EXPECT_NE(url.error().message.find("/v1/meshes/NAME"), std::string::npos);
  }
}

}  // namespace
}  // namespace meshfront
