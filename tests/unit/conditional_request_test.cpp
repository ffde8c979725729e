#include "shared/http/conditional_request.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(IfNoneMatch, MatchesTagsListsWeakOnesAndTheStar) {
  for (const char* field : {"\"a\"", "W/\"a\"", "*", "\"b\", \"a\"", "\"b\",W/\"a\"",
                            " \"b\" ,\t\"a\" ", ", \"a\"", "\"x,y\", \"a\"", "W/\"b\", \"a\""})
    EXPECT_TRUE(ifNoneMatchHolds(field, "\"a\"")) << field;
}

TEST(IfNoneMatch, MatchesNothingElse) {
  for (const char* field : {"", "\"b\"", "a", "\"a", "\"A\"", "\"aa\"", "\"\"", "w/\"a\"",
                            "garbage, \"a\"", "\"b\" x \"a\"", "\"b,\"a\""})
    EXPECT_FALSE(ifNoneMatchHolds(field, "\"a\"")) << field;
}

}  // namespace
}  // namespace meshfront
