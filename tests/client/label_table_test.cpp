#include "client/library/label_table.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(LabelTable, TakesLabelsOfAllNumbersOfSixtyFourBits) {
  const auto names = parse_label_table(
      R"([{"value": 9223372036854775807, "name": "high"}, {"value": -1, "name": "low"}])");
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_EQ(names->at(0).value, 9223372036854775807);
  EXPECT_EQ(names->at(1).value, -1);
}

TEST(LabelTable, RefusesANumberThatNoLabelHas) {
  for (const char* const text : {R"([{"value": 18446744073709551615, "name": "x"}])",
                                 R"({"18446744073709551615": "x"})"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(parse_label_table(text).status())) << text;
  }
}

}  // namespace
}  // namespace tet
