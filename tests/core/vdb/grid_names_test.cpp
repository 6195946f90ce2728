#include "core/vdb/walk/grid_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/utf8.h"
#include "core/volume/grid_info.h"

namespace tet {
namespace {

using ::testing::ElementsAre;
using Names = std::vector<std::string>;

TEST(GridNames, NumberGridsOfOneName) {
  EXPECT_THAT(shown_names(Names{"a\x1e"
                                "0",
                                "b",
                                "a\x1e"
                                "1"}),
              ElementsAre("a[0]", "b", "a[1]"));
}

TEST(GridNames, LeaveANameToTheGridThatIsCalledSo) {
  EXPECT_THAT(shown_names(Names{"a\x1e"
                                "0",
                                "a\x1e"
                                "1",
                                "a[0]"}),
              ElementsAre("a[1]", "a[2]", "a[0]"));
  EXPECT_THAT(shown_names(Names{"a[1]",
                                "a\x1e"
                                "0",
                                "a\x1e"
                                "1"}),
              ElementsAre("a[1]", "a[0]", "a[2]"));
}

TEST(GridNames, AreUtf8) {
  EXPECT_THAT(shown_names(Names{"f\xfcr", "\xe5\xaf\x86"}),
              ElementsAre("f\xc3\xbcr", "\xe5\xaf\x86"));
  EXPECT_THAT(shown_names(Names{"f\xfcr", "f\xc3\xbcr"}),
              ElementsAre("f\xc3\xbcr", "f\xc3\xbcr[0]"));
  const std::string longest = shown_names(Names{std::string(1024, '\xfc')}).front();
  EXPECT_LE(longest.size(), kMaxGridNameBytes);
  EXPECT_TRUE(is_utf8(longest));
}

TEST(GridNames, AreEmptyOnlyForASingleGrid) {
  EXPECT_THAT(shown_names(Names{""}), ElementsAre(""));
  EXPECT_THAT(shown_names(Names{"", "a"}), ElementsAre("[0]", "a"));
  EXPECT_THAT(shown_names(Names{"\x1e"
                                "0",
                                "\x1e"
                                "1"}),
              ElementsAre("[0]", "[1]"));
}

}  // namespace
}  // namespace tet
