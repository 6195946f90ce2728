// Drawings of a report as SVG, without scripts.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace tet {

/// Text as it may stand in HTML, in quotes too.
std::string html_text(std::string_view text);

/// Bars from `low` to `high`, one a count; whoever points at one is told its range and its
/// count. `unit` follows the numbers below.
struct BarChart {
  std::vector<double> counts;
  double low = 0, high = 1;
  bool octaves = false;  ///< the numbers below are powers of two
  std::string unit = {};
};
std::string draw_bars(const BarChart& chart);

/// Places seen along each axis, in a frame of the mesh's bounds.
struct PlaceChart {
  std::array<double, 3> min{}, max{};
  struct Mark {
    std::array<double, 3> at{};
    std::string text, kind;  ///< what it is called, and its class in the page's style
  };
  std::vector<Mark> marks;
};
std::string draw_places(const PlaceChart& chart);

}  // namespace tet
