#include "shared/http/route.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace meshfront {
namespace {

const std::string kRevision = "0123456789abcdef0123456789abcdef";

TEST(Route, KnowsTheResourcesOfTheInterface) {
  const std::string fixed = "/v1/meshes/bunny/" + kRevision;
  EXPECT_EQ(parseTarget("/v1/meshes").kind, RouteKind::catalogue);
  EXPECT_EQ(parseTarget("/v1/meshes/bunny").kind, RouteKind::mesh);
  EXPECT_EQ(parseTarget(fixed + "/base").kind, RouteKind::base);
  EXPECT_EQ(parseTarget(fixed + "/splits").kind, RouteKind::querySplits);
  EXPECT_EQ(parseTarget(fixed + "/splits/AAA").kind, RouteKind::splits);
  EXPECT_EQ(parseTarget(fixed + "/chunks").kind, RouteKind::chunks);
  EXPECT_EQ(parseTarget(fixed + "/chunks/12").kind, RouteKind::chunk);
  EXPECT_EQ(parseTarget("/healthz").kind, RouteKind::health);
  EXPECT_EQ(parseTarget("/readyz").kind, RouteKind::ready);
  EXPECT_EQ(parseTarget("/metrics").kind, RouteKind::metrics);
  EXPECT_EQ(parseTarget("*").kind, RouteKind::server);
}

TEST(Route, TakesTheTargetApart) {
  const std::string target = "/v1/meshes/b-1/" + kRevision + "/splits/Abc_-?levels=2";
  const Route route = parseTarget(target);
  EXPECT_EQ(route.mesh, "b-1");
  EXPECT_EQ(route.revision, kRevision);
  EXPECT_EQ(route.last, "Abc_-");
  EXPECT_TRUE(route.hasQuery);
  EXPECT_EQ(route.query, "levels=2");
}

TEST(Route, TakesTheAbsoluteForm) {
  const Route route = parseTarget("http://example.org:80/v1/meshes/bunny");
  EXPECT_EQ(route.kind, RouteKind::mesh);
  EXPECT_EQ(route.mesh, "bunny");
  EXPECT_EQ(parseTarget("http://example.org").kind, RouteKind::unknown);
}

TEST(Route, RefusesEverythingElse) {
  const std::string fixed = "/v1/meshes/bunny/" + kRevision;
  const std::vector<std::string> targets{"",
                                         "/",
                                         "/v1",
                                         "/v1/meshes/",
                                         "/v1/meshesx",
                                         "/v2/meshes",
                                         "/v1/meshes/bun%6Ey",
                                         "/v1/meshes/../x",
                                         "/v1/meshes/.bunny",
                                         "/v1/meshes/bunny/",
                                         "/v1/meshes/bunny/base",
                                         "/v1/meshes/bunny/" + kRevision,
                                         fixed + "/",
                                         fixed + "/bases",
                                         fixed + "/base/",
                                         fixed + "/splits/A/B",
                                         fixed.substr(0, fixed.size() - 1) + "/base",
                                         fixed + "0/base",
                                         "/v1/meshes/bunny/0123456789ABCDEF0123456789ABCDEF/base"};
  for (const std::string& target : targets)
    EXPECT_EQ(parseTarget(target).kind, RouteKind::unknown) << target;
}

}  // namespace
}  // namespace meshfront
