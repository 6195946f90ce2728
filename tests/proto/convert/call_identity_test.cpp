#include "proto/convert/call_identity.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

constexpr char kParent[] = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";

TEST(TraceSpan, IsANewSpanOfTheCallersTrace) {
  const TraceSpan span = span_below(kParent);
  EXPECT_EQ(span.trace_id, "0af7651916cd43dd8448eb211c80319c");
  EXPECT_EQ(span.parent_id, "b7ad6b7169203331");
  EXPECT_EQ(span.span_id.size(), 16U);
  EXPECT_NE(span.span_id, span_below(kParent).span_id);
  EXPECT_EQ(span.traceparent(), "00-0af7651916cd43dd8448eb211c80319c-" + span.span_id + "-01");
}

TEST(TraceSpan, TakesAVersionThatGoesOn) {
  const std::string later = "cc" + std::string(kParent).substr(2) + "-more";
  EXPECT_FALSE(span_below(later).trace_id.empty());
}

TEST(TraceSpan, IgnoresWhatIsMalformed) {
  const std::string parent = kParent;
  for (const std::string& text :
       {std::string(), parent.substr(1), parent + "0", parent + "-more",
        "ff" + parent.substr(2),
        "00-0AF7651916CD43DD8448EB211C80319C-b7ad6b7169203331-01" + std::string(),
        "00-" + std::string(32, '0') + "-b7ad6b7169203331-01",
        "00-0af7651916cd43dd8448eb211c80319c-" + std::string(16, '0') + "-01",
        std::string(55, '-')}) {
    EXPECT_TRUE(span_below(text).trace_id.empty()) << text;
    EXPECT_EQ(span_below(text).traceparent(), "");
  }
}

}  // namespace
}  // namespace tet
