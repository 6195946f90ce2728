#include "client/command/report/report_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>

namespace tet {
namespace {

constexpr double kWidth = 640, kHeight = 150, kFoot = 18;

std::string number_below(const BarChart& chart, double at) {
  return absl::StrFormat("%.4g%s", chart.octaves ? std::exp2(at) : at, chart.unit);
}

/// Five numbers below the bars.
std::string scale_of(const BarChart& chart) {
  constexpr int kSteps = 4;
  std::string text;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const char* const anchor = i == 0 ? "start" : i == kSteps ? "end" : "middle";
    absl::StrAppendFormat(
        &text, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>", kWidth * share,
        kHeight + kFoot - 4, anchor,
        html_text(number_below(chart, chart.low + share * (chart.high - chart.low))));
  }
  return text;
}

struct Side {
  const char* title;
  std::size_t across, up;
};
constexpr std::array kSides{Side{"from above: x, y", 0, 1}, Side{"from the front: x, z", 0, 2},
                            Side{"from the side: y, z", 1, 2}};

std::string draw_side(const PlaceChart& chart, const Side& side) {
  constexpr double kMost = 200;
  const auto extent = [&](std::size_t axis) { return chart.max[axis] - chart.min[axis]; };
  const double longest = std::max({extent(0), extent(1), extent(2)});
  const double scale = longest > 0 ? kMost / longest : 0;
  const double width = std::max(1.0, scale * extent(side.across)),
               height = std::max(1.0, scale * extent(side.up));
  std::string text = absl::StrFormat(
      "<figure><svg viewBox=\"-8 -8 %.1f %.1f\" width=\"%.0f\" height=\"%.0f\">"
      "<rect class=\"frame\" width=\"%.1f\" height=\"%.1f\"/>",
      width + 16, height + 16, width + 16, height + 16, width, height);
  for (const PlaceChart::Mark& mark : chart.marks) {
    // What is far away is marked at the frame.
    const auto within = [&](std::size_t axis, double size) {
      return std::clamp(scale * (mark.at[axis] - chart.min[axis]), -6.0, size + 6);
    };
    absl::StrAppendFormat(
        &text,
        "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"><title>%s</title></circle>",
        html_text(mark.kind), within(side.across, width), height - within(side.up, height),
        html_text(mark.text));
  }
  return absl::StrCat(text, "</svg><figcaption>", side.title, "</figcaption></figure>\n");
}

}  // namespace

std::string html_text(std::string_view text) {
  return absl::StrReplaceAll(std::string(text),
                             {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

std::string draw_bars(const BarChart& chart) {
  if (chart.counts.empty()) return "";
  const double most = *std::ranges::max_element(chart.counts);
  const double wide = kWidth / static_cast<double>(chart.counts.size());
  const double step = (chart.high - chart.low) / static_cast<double>(chart.counts.size());
  std::string text = absl::StrFormat(
      "<svg class=\"bars\" viewBox=\"0 0 %.0f %.0f\" role=\"img\">", kWidth, kHeight + kFoot);
  for (std::size_t i = 0; i < chart.counts.size(); ++i) {
    const double count = chart.counts[i];
    if (!(count > 0)) continue;
    // A few are as worth a look as many: they are never less than two pixels.
    const double high = std::max(2.0, kHeight * count / most);
    const double low = chart.low + static_cast<double>(i) * step;
    absl::StrAppendFormat(
        &text,
        "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"><title>%s to %s: %.0f"
        "</title></rect>",
        static_cast<double>(i) * wide, kHeight - high, 0.9 * wide, high,
        html_text(number_below(chart, low)), html_text(number_below(chart, low + step)), count);
  }
  return absl::StrCat(text, scale_of(chart), "</svg>\n");
}

std::string draw_places(const PlaceChart& chart) {
  std::string text = "<div class=\"places\">";
  for (const Side& side : kSides) text += draw_side(chart, side);
  return text + "</div>\n";
}

}  // namespace tet
