#include "core/files/read_points.h"

#include <algorithm>
#include <string>

#include "core/triangle_files/surface_reading.h"

namespace tet {

absl::StatusOr<std::vector<WorldPoint>> read_points(std::string_view text) {
  std::vector<WorldPoint> points;
  LineReader lines(without_byte_order_mark(text));
  while (lines.next()) {
    std::string line(lines.line().substr(0, lines.line().find('#')));
    std::ranges::replace(line, ',', ' ');
    std::string_view rest = line;
    std::string_view probe = line;
    if (take_word(probe).empty()) continue;
    WorldPoint point;
    if (!take_point(rest, point) || !take_word(rest).empty()) {
      return line_error(lines.number(), "a point is three finite numbers");
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace tet
