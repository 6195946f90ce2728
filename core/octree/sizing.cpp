#include "core/octree/sizing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/string_view.h>

namespace tet {
namespace {

/// Lengths beyond these are no world's.
constexpr double kMinLength = 1e-15, kMaxLength = 1e15;
/// Sizes are typed with a few digits: this much below a leaf's edge means it.
constexpr double kSameSize = 1e-6;

/// Collects what is wrong; the first complaint stays.
class Complaints {
 public:
  void positive(absl::string_view field, double value) {
    if (value >= kMinLength && value <= kMaxLength) return;
    say(field, absl::StrFormat("%g is not from %g to %g", value, kMinLength, kMaxLength));
  }
  void finite(absl::string_view field, const WorldPoint& point) {
    int at = 0;
    for (const double value : {point.x, point.y, point.z}) {
      if (!(std::abs(value) <= kMaxLength)) {
        say(absl::StrCat(field, "[", at, "]"),
            absl::StrFormat("%g is not from %g to %g", value, -kMaxLength, kMaxLength));
      }
      ++at;
    }
  }
  void say(absl::string_view field, absl::string_view what) {
    if (!status_.ok()) return;
    status_ = absl::InvalidArgumentError(absl::StrCat(path_, field, " ", what));
  }
  void enter(std::string path) { path_ = std::move(path); }
  const absl::Status& status() const { return status_; }

 private:
  std::string path_;
  absl::Status status_;
};

void check(const std::monostate&, Complaints& is) {
  is.say("shape", "is not set: set box, ball, capsule or shell");
}

void check(const WorldBox& box, Complaints& is) {
  is.finite("box.min", box.min);
  is.finite("box.max", box.max);
  const auto& [min, max] = box;
  if (min.x < max.x && min.y < max.y && min.z < max.z) return;
  is.say("box", absl::StrFormat("from min (%g, %g, %g) to max (%g, %g, %g) is empty: min must "
                                "be below max on every axis",
                                min.x, min.y, min.z, max.x, max.y, max.z));
}

void check(const BallRegion& ball, Complaints& is) {
  is.finite("ball.centre", ball.centre);
  is.positive("ball.radius", ball.radius);
}

void check(const CapsuleRegion& capsule, Complaints& is) {
  is.finite("capsule.start", capsule.start);
  is.finite("capsule.end", capsule.end);
  is.positive("capsule.radius", capsule.radius);
}

void check(const ShellRegion& shell, Complaints& is) {
  is.positive("shell.depth", shell.depth);
}

bool is_below(double size, double spacing) { return size < spacing * (1 - kSameSize); }

std::string below_spacing(double size, double spacing) {
  return absl::StrFormat(
      "%g is below the spacing %g, the size of the smallest leaves: use a larger one", size,
      spacing);
}

}  // namespace

absl::Status check_sizing(const Sizing& sizing) {
  Complaints is;
  if (sizing.coarsest) is.positive("coarsest", *sizing.coarsest);
  if (!(sizing.growth >= Sizing::kMinGrowth && sizing.growth <= 1)) {
    is.say("growth",
           absl::StrFormat("%g is not from %g to 1", sizing.growth, Sizing::kMinGrowth));
  }
  if (sizing.grade_surface && !sizing.coarsest) {
    is.say("coarsest", "must be set where grade_surface is: leaves at the surface are as long");
  }
  if (sizing.chord_error) is.positive("chord_error", *sizing.chord_error);
  if (sizing.leaves_across < 0 || sizing.leaves_across > Sizing::kMaxLeavesAcross) {
    is.say("leaves_across", absl::StrFormat("%d is not from 0 to %d", sizing.leaves_across,
                                            Sizing::kMaxLeavesAcross));
  }
  if (sizing.sizes_surface() && !sizing.grade_surface) {
    is.say(sizing.chord_error ? "chord_error" : "leaves_across",
           "is set without grade_surface: leaves at the surface are all finest");
  }
  if (sizing.regions.size() > Sizing::kMaxRegions) {
    is.say("regions", absl::StrCat("has ", sizing.regions.size(), " entries; the limit is ",
                                   Sizing::kMaxRegions));
  }
  for (std::size_t i = 0; i < sizing.regions.size() && is.status().ok(); ++i) {
    is.enter(absl::StrCat("regions[", i, "]."));
    is.positive("size", sizing.regions[i].size);
    std::visit([&](const auto& shape) { check(shape, is); }, sizing.regions[i].shape);
  }
  return is.status();
}

absl::Status check_sizing(const Sizing& sizing, double spacing) {
  Complaints is;
  if (sizing.coarsest && is_below(*sizing.coarsest, spacing)) {
    is.say("coarsest", below_spacing(*sizing.coarsest, spacing));
  }
  for (std::size_t i = 0; i < sizing.regions.size(); ++i) {
    const double size = sizing.regions[i].size;
    if (!is_below(size, spacing)) continue;
    is.say(absl::StrCat("regions[", i, "].size"), below_spacing(size, spacing));
  }
  return is.status();
}

int level_of_size(double size, double spacing, int max_levels) noexcept {
  const double ratio = size / spacing * (1 + kSameSize);
  return ratio < 1 ? 0 : std::min(std::ilogb(ratio), max_levels);
}

}  // namespace tet
