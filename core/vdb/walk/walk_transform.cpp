#include "core/vdb/walk/walk_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <absl/strings/str_format.h>

#include "core/base/vec3.h"
#include "core/vdb/walk/walk_refusal.h"

namespace tet {
namespace {

constexpr std::size_t kLongestMapType = 64;

/// What is repeated was computed by other compilers in other ways.
constexpr double kTolerance = 1e-6;

double read_number(VdbCursor& cursor, const char* what) {
  const std::uint64_t at = cursor.position();
  const auto number = cursor.read<double>(what);
  if (!std::isfinite(number)) {
    refuse_at(at, absl::StrFormat("the %s is %g, which is not finite", what, number));
  }
  return number;
}

Triple read_triple(VdbCursor& cursor, const char* what) {
  Triple triple{};
  for (double& number : triple) number = read_number(cursor, what);
  return triple;
}

/// `stored` is what follows from a scale, on each axis.
void check_derived(std::uint64_t at, const Triple& stored, const Triple& derived) {
  for (std::size_t i = 0; i < 3; ++i) {
    const bool close = std::abs(stored[i] - derived[i]) <= kTolerance * std::abs(derived[i]);
    if (!close) {
      refuse_at(at, absl::StrFormat("the transform says %g where its scale gives %g", stored[i],
                                    derived[i]));
    }
  }
}

template <class Function>
Triple each(const Triple& triple, const Function& function) {
  return {function(triple[0]), function(triple[1]), function(triple[2])};
}

/// A scale, then what OpenVDB stores beside it so as not to compute it again.
void walk_scale(VdbCursor& cursor, bool uniform, AxisMap& map) {
  const std::uint64_t at = cursor.position();
  const Triple scale = read_triple(cursor, "scale");
  if (uniform && (scale[0] != scale[1] || scale[0] != scale[2])) {
    refuse_at(at,
              absl::StrFormat("a uniform scale is %g, %g, %g", scale[0], scale[1], scale[2]));
  }
  for (const double s : scale) {
    if (!std::isnormal(s)) refuse_at(at, absl::StrFormat("the scale %g is not usable", s));
  }
  map.scales = true;
  map.scale = scale;
  map.voxel_size = read_triple(cursor, "voxel size");
  check_derived(at, map.voxel_size, each(scale, [](double s) { return std::abs(s); }));
  check_derived(at, read_triple(cursor, "inverse scale"),
                each(scale, [](double s) { return 1 / s; }));
  check_derived(at, read_triple(cursor, "inverse scale squared"),
                each(scale, [](double s) { return 1 / s * (1 / s); }));
  check_derived(at, read_triple(cursor, "inverse of twice the scale"),
                each(scale, [](double s) { return 0.5 / s; }));
}

/// Row vectors are multiplied from the left, so the last column is (0, 0, 0, 1).
void walk_matrix(VdbCursor& cursor) {
  const std::uint64_t at = cursor.position();
  for (int i = 0; i < 16; ++i) {
    const double number = read_number(cursor, "matrix");
    if (i % 4 == 3 && std::abs(number - (i == 15 ? 1 : 0)) > kTolerance) {
      refuse_at(at, absl::StrFormat("a matrix has %g in its last column", number));
    }
  }
}

void walk_translation(VdbCursor& cursor, AxisMap& map) {
  map.moves = true;
  map.translation = read_triple(cursor, "translation");
}

/// False when there is no linear map of that name. One that may turn leaves `along_axes`
/// empty.
bool walk_linear_map(VdbCursor& cursor,
                     std::string_view name,
                     std::optional<AxisMap>& along_axes) {
  AxisMap map;
  if (name == "AffineMap" || name == "UnitaryMap") {
    walk_matrix(cursor);
    return true;
  } else if (name == "ScaleMap" || name == "UniformScaleMap") {
    walk_scale(cursor, name == "UniformScaleMap", map);
  } else if (name == "TranslationMap") {
    walk_translation(cursor, map);
  } else if (name == "ScaleTranslateMap" || name == "UniformScaleTranslateMap") {
    walk_translation(cursor, map);
    walk_scale(cursor, name == "UniformScaleTranslateMap", map);
  } else {
    return false;
  }
  along_axes = map;
  return true;
}

void walk_frustum(VdbCursor& cursor) {
  const std::uint64_t at = cursor.position();
  const Triple min = read_triple(cursor, "frustum box");
  const Triple max = read_triple(cursor, "frustum box");
  for (std::size_t i = 0; i < 3; ++i) {
    if (min[i] >= max[i]) {
      refuse_at(at, absl::StrFormat("a frustum reaches from %g to %g", min[i], max[i]));
    }
  }
  read_number(cursor, "frustum taper");
  read_number(cursor, "frustum depth");
  const std::uint64_t map_at = cursor.position();
  const std::string name =
      cursor.read_string(kLongestMapType, "frustum map type", "frustum map type text");
  std::optional<AxisMap> inner;
  if (!walk_linear_map(cursor, name, inner)) {
    refuse_at(map_at, absl::StrFormat("%s is not a linear map", quoted_name(name)));
  }
}

}  // namespace

std::optional<AxisMap> walk_transform(VdbCursor& cursor) {
  std::optional<AxisMap> map;
  const std::uint64_t at = cursor.position();
  const std::string name =
      cursor.read_string(kLongestMapType, "transform type", "transform type text");
  if (name == "NonlinearFrustumMap") {
    walk_frustum(cursor);
  } else if (!walk_linear_map(cursor, name, map)) {
    refuse_at(at, absl::StrFormat("the transform %s is not known", quoted_name(name)));
  }
  return map;
}

}  // namespace tet
