#include "core/image/nrrd_axis.h"

#include <algorithm>
#include <cmath>

#include <absl/strings/str_format.h>

#include "core/image/image_refusal.h"

namespace tet {
namespace {

/// Spacings between min and max.
double spacings_of(const PlainAxis& axis, Centering as) {
  return as == Centering::kNode ? axis.size - 1 : axis.size;
}

/// Whether max is where the voxels end, to within half a voxel: spacings are rounded, which
/// adds up along an axis, and cells that were taken for nodes are a whole voxel off.
bool ends_at_max(const PlainAxis& axis, Centering as) {
  const double end = *axis.min + spacings_of(axis, as) * axis.step();
  const double distance = std::abs(end - *axis.max);
  return distance < 0.5 * std::abs(axis.step()) ||
         distance <= 1e-6 * std::max(std::abs(*axis.min), std::abs(*axis.max));
}

/// Whether spacing and ends agree, by either centering where none is said.
bool agrees(const PlainAxis& axis) {
  if (!axis.min || !axis.max) return true;
  if (axis.centering != Centering::kUnsaid) return ends_at_max(axis, axis.centering);
  return ends_at_max(axis, Centering::kCell) || ends_at_max(axis, Centering::kNode);
}

}  // namespace

double PlainAxis::step() const {
  if (spacing) return *spacing;
  const bool spans =
      min && max && centering != Centering::kUnsaid && spacings_of(*this, centering) > 0;
  return spans ? (*max - *min) / spacings_of(*this, centering) : 1;
}

double PlainAxis::origin() const {
  if (!min) return 0;
  return centering == Centering::kCell ? *min + step() / 2 : *min;
}

void check_plain_axis(const PlainAxis& axis, std::size_t number) {
  if (agrees(axis)) return;
  refuse_image(absl::StrFormat(
      "its axis %d goes from %g to %g by 'axis mins' and 'axis maxs', and has %g voxels of %g: "
      "correct them, say 'centers' (cell or node), or leave 'axis maxs' out",
      number, *axis.min, *axis.max, axis.size, axis.step()));
}

}  // namespace tet
