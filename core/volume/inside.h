// Which side of a grid's surface is inside, and at which value: what its class says, or its
// values tell, or a request says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "core/volume/volume.h"

namespace tet {

/// A request's field, and the command line's option.
inline constexpr char kInsideField[] = "inside";

/// What the values of a grid without class mean, and who says so.
struct KindOfValues {
  VolumeKind kind = VolumeKind::kLevelSet;
  KindSource source = KindSource::kNobody;

  friend bool operator==(const KindOfValues&, const KindOfValues&) = default;
};

/// Guesses from the range of all values, the background among them. Nobody tells where both
/// sides would do: a negative background with larger values may be an inverted level set or a
/// scan, and with a background of 0 either sign may be the solid's.
KindOfValues kind_of_values(ValueRange range, float background) noexcept;

/// The range of all values, the background among them.
ValueRange value_range(const Volume& volume) noexcept;

/// What is inside where the request does not say.
InsideSide own_side(const Volume& volume) noexcept;
inline InsideSide inside_side(const Volume& volume, std::optional<InsideSide> asked) noexcept {
  return asked.value_or(own_side(volume));
}

/// The value at the surface unless another is asked for: 0 of level sets and 0.5 of densities.
/// Where a request contradicts the grid's class, or nothing tells, 0 below; and above 0 if any
/// value is negative, else 0.5.
double default_iso(const Volume& volume, std::optional<InsideSide> asked) noexcept;

/// Whether somebody has said which side is inside. Errors: kInvalidArgument, beginning with the
/// field: nobody has and the values do not tell; or the grid's class or values tell, but what
/// surrounds the grid would be inside at `iso`, as in an inverted level set.
absl::Status check_side(const Volume& volume, std::optional<InsideSide> asked);
absl::Status check_background(const Volume& volume,
                              std::optional<InsideSide> asked,
                              double iso);

/// Says for people which side was guessed, and why; empty where the class, the maker or the
/// request says it.
std::string describe_guess(const Volume& volume, std::optional<InsideSide> asked, double iso);

/// Names what the class and the background of such a grid contradict each other in.
std::string describe_inverted(const Volume& volume, InsideSide inside, double iso);

const char* side_name(InsideSide side) noexcept;  ///< "below", "above"
std::optional<InsideSide> parse_side(std::string_view name) noexcept;

}  // namespace tet
