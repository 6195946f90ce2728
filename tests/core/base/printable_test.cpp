#include "core/base/printable.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(ForTerminal, LeavesTextOfEveryLanguageAsItIs) {
  for (const char* text : {"", "bunny", "größe", "兎", "\xf0\x9f\x90\x87", "a\\b \"c\""}) {
    EXPECT_EQ(for_terminal(text), text);
  }
}

TEST(ForTerminal, EscapesWhatWouldActOnATerminal) {
  EXPECT_EQ(for_terminal("\x1b]0;title\x07"), "\\x1b]0;title\\x07");
  EXPECT_EQ(for_terminal("a\nb\rc\td"), "a\\nb\\rc\\td");
  EXPECT_EQ(for_terminal(std::string("\0\x7f", 2)), "\\x00\\x7f");
  EXPECT_EQ(for_terminal("\xc2\x9b"
                         "31m"),
            "\\u009b31m");  // C1, as UTF-8
  EXPECT_EQ(for_terminal("\xe2\x80\xae"
                         "gpj.exe"),
            "\\u202egpj.exe");
  EXPECT_EQ(for_terminal("\xe2\x81\xa6\xe2\x80\xa8\xef\xbb\xbf"), "\\u2066\\u2028\\ufeff");
  EXPECT_EQ(for_terminal("\xf3\xa0\x80\x81"), "\\U000e0001");
}

TEST(ForTerminal, EscapesWhatIsNoUtf8ByteByByte) {
  EXPECT_EQ(for_terminal("\x9b"
                         "31m"),
            "\\x9b31m");                                       // C1, as a byte
  EXPECT_EQ(for_terminal("a\xff\xc3"), "a\\xff\\xc3");         // cut short
  EXPECT_EQ(for_terminal("\xc0\x9b"), "\\xc0\\x9b");           // overlong
  EXPECT_EQ(for_terminal("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // a surrogate
}

TEST(LinesForTerminal, KeepsLinesApart) {
  EXPECT_EQ(lines_for_terminal("a\nb\r\n\x1b[A"), "a\nb\\r\n\\x1b[A");
}

TEST(Printable, CutsAndLeavesPrintableAscii) {
  EXPECT_EQ(printable("a\nb\xff", 10), "a?b?");
  EXPECT_EQ(printable("abcdef", 3), "abc");
}

}  // namespace
}  // namespace tet
