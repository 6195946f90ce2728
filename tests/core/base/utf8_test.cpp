#include "core/base/utf8.h"

#include <string>

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(Utf8, IsTextInAnyScript) {
  for (const std::string text : {"", "density", "плотность", "密度", "\xf0\x9f\x90\xb0"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
  }
}

TEST(Utf8, IsNoOtherEncodingAndNoForgery) {
  const std::string wrong[] = {
      "\x80",              // a byte that only continues
      "dichte f\xfcr",     // Latin-1
      "\xc3",              // cut
      "\xc0\xaf",          // '/' in more bytes than it takes
      "\xe0\x80\xaf",      //
      "\xed\xa0\x80",      // half of a UTF-16 pair
      "\xf4\x90\x80\x80",  // beyond the last character
      "\xff",              //
  };
  for (const std::string& text : wrong) EXPECT_FALSE(is_utf8(text)) << text.size();
}

TEST(Utf8, IsMadeOfLatin1) {
  EXPECT_EQ(as_utf8("f\xfcr", 10), "f\xc3\xbcr");
  EXPECT_EQ(as_utf8("f\xfcr", 3), "f\xc3\xbc");
  EXPECT_EQ(as_utf8("f\xc3\xbcr", 10), "f\xc3\xbcr");
}

TEST(Utf8, IsCutBetweenCharacters) {
  EXPECT_EQ(cut_utf8("плотность", 5), "пл");
  EXPECT_EQ(cut_utf8("plain", 100), "plain");
  EXPECT_EQ(cut_utf8("a\xc2\x9b"
                     "b",
                     100),
            "ab");
  EXPECT_EQ(cut_utf8("\xf0\x9f\x90\xb0", 3), "");
}

}  // namespace
}  // namespace tet
