// What a reader says it does not carry reaches the report, the pack and the user.
#include "shared/mesh_files/not_carried.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "encoder/pipeline/encode_mesh.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

TEST(NotCarried, ReachesReportPackAndUser) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.ply")
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nproperty float \xff\x1b\"\nelement face 2\n"
         "property list uchar int vertex_indices\nend_header\n"
         "0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 0 2\n3 0 1 2\n3 3 2 1\n";
  EncodeOptions options;
  options.name = "test";
  const auto encoded = encodeFile(folder / "a.ply", options);
  ASSERT_TRUE(encoded) << encoded.error().message;
  const std::vector<std::string> expected = {"extra vertex properties: ??\""};
  EXPECT_EQ(encoded->report.notCarried, expected);
  for (const std::string& json : {toJson(encoded->report, true), encoded->pack.reportJson})
    EXPECT_EQ(nlohmann::json::parse(json)["notCarried"], nlohmann::json(expected));
  EXPECT_NE(describe(encoded->report).find("not carried " + expected[0] + "\n"), std::string::npos);
}

TEST(NotCarried, NamesArePrintableAndShort) {
  EXPECT_EQ(printableName("a\tb\xc3\xa4"), "a?b??");
  EXPECT_EQ(printableName(std::string(41, 'x')), std::string(40, 'x') + "...");
  NameList names;
  EXPECT_TRUE(names.empty());
  for (int i = 0; i < 13; ++i) names.add("n");
  EXPECT_EQ(names.text(), "n, n, n, n, n, n, n, n, n, n, n, n and 1 more");
}

}  // namespace
}  // namespace meshfront
