#include "core/mesh/improve/label_mover.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/improve/angle_survey.h"
#include "core/mesh/improve/faces_around.h"
#include "core/mesh/improve/place_search.h"

namespace tet {
namespace {

/// A vertex so near to where its labels meet is there; spacings.
constexpr double kArrived = 1e-3;
/// More than any star costs.
constexpr double kAnyCost = 2;

double distance(const WorldPoint& a, const WorldPoint& b) noexcept {
  const Vector way = from_to(a, b);
  return std::sqrt(dot(way, way));
}

/// Leads a vertex through a label, or along where labels meet.
struct LabelGuide {
  InterfaceProjector& projector;
  bool within_label;

  Vector along(const Vector& way) const noexcept {
    return within_label ? way : projector.along(way);
  }
  std::optional<WorldPoint> settle(const WorldPoint& ahead) {
    return within_label ? projector.rounded(ahead)
                        : projector.project(ahead, projector.levels());
  }
};

}  // namespace

LabelMover::LabelMover(const TetMesh& mesh,
                       const LabelledSpace& space,
                       const MeshView& before,
                       const AngleRange& mesh_angles)
    : mesh_(mesh),
      space_(space),
      before_(before),
      goal_(good_angles()),
      limit_{std::min(goal_.good.largest_cosine, mesh_angles.largest_cosine),
             std::max(goal_.good.smallest_cosine, mesh_angles.smallest_cosine)},
      projector_(space.source.probe(), space.to_world, mesh.header),
      star_(goal_) {}

void LabelMover::Meeting::add(Label added) noexcept {
  const auto end = label.begin() + static_cast<std::ptrdiff_t>(count);
  const auto at = std::lower_bound(label.begin(), end, added);
  if (at != end && *at == added) return;
  if (count == kMostMeeting) {
    fixed = true;
    return;
  }
  std::move_backward(at, end, end + 1);
  *at = added;
  ++count;
}

bool LabelMover::near_domain_face(const WorldPoint& place) const noexcept {
  const WorldPoint p = projector_.lattice_of(place);
  const auto near = [](double at, double low, double high) {
    return at < low + 1 || at > high - 1;
  };
  const auto& [min, max] = space_.domain;
  return near(p.x, min.x, max.x) || near(p.y, min.y, max.y) || near(p.z, min.z, max.z);
}

LabelMover::Meeting LabelMover::meeting_of(std::span<const TetCorner> star,
                                           const WorldPoint& place) const noexcept {
  Meeting meeting;
  for (const TetCorner corner : star) meeting.add(mesh_.label(corner.tet()));
  if (meeting.fixed || !faces_around(mesh_, star).on_boundary()) return meeting;
  if (space_.kept.all() || near_domain_face(place)) {
    meeting.fixed = true;
  } else {
    meeting.add(space_.kept.left_out);
  }
  return meeting;
}

std::optional<double> LabelMover::cost_at(const std::optional<WorldPoint>& place) noexcept {
  if (!place || distance(home_, *place) > kReach * mesh_.header.spacing) return std::nullopt;
  return star_.cost_below(bound_, *place);
}

LabelMover::Outcome LabelMover::approach(std::uint64_t vertex,
                                         std::span<const TetCorner> star) {
  return bring_nearer(vertex, star, false);
}

LabelMover::Outcome LabelMover::approach_aside(std::uint64_t vertex,
                                               std::span<const TetCorner> star) {
  return bring_nearer(vertex, star, true);
}

LabelMover::Outcome LabelMover::bring_nearer(std::uint64_t vertex,
                                             std::span<const TetCorner> star,
                                             bool aside) {
  const WorldPoint start = mesh_.stored_position(vertex);
  const Meeting meeting = meeting_of(star, start);
  if (meeting.fixed || meeting.count < 2) return {{}, true};
  if (!projector_.enter(meeting.labels(), start)) return {{}, true};
  const std::optional<WorldPoint> target = projector_.project(start, {});
  if (!target) return {{}, true};
  const Vector way = from_to(start, *target);
  if (std::sqrt(dot(way, way)) <= kArrived * mesh_.header.spacing) return {{}, true};

  star_.gather(mesh_, star);
  const AngleRange before = star_.angles(start);
  home_ = before_.stored_position(vertex);
  bound_ = {{std::max(before.largest_cosine, signed_square_of_cosine(kNearMinDihedralDeg)),
             std::min(before.smallest_cosine, signed_square_of_cosine(kNearMaxDihedralDeg))},
            kAnyCost};
  for (const double share : {1.0, 0.75, 0.5, 0.25}) {
    InterfaceProjector::Levels levels = projector_.levels();
    for (double& level : levels) level *= 1 - share;
    const WorldPoint ahead{start.x + share * way.x, start.y + share * way.y,
                           start.z + share * way.z};
    std::optional<WorldPoint> place = projector_.project(ahead, levels);
    if (!cost_at(place)) place = aside ? find_aside(ahead, levels) : std::nullopt;
    if (place) return {place, share == 1};
  }
  return {};
}

/// The one that costs least of some beside it.
std::optional<WorldPoint> LabelMover::find_aside(const WorldPoint& ahead,
                                                 const InterfaceProjector::Levels& levels) {
  std::optional<WorldPoint> best;
  double least = kAnyCost;
  for (const double aside : {0.08, -0.08, 0.2, -0.2}) {
    for (const Vector& tangent : projector_.tangents()) {
      const double step = aside * mesh_.header.spacing;
      const std::optional<WorldPoint> beside = projector_.project(
          {ahead.x + step * tangent.x, ahead.y + step * tangent.y, ahead.z + step * tangent.z},
          levels);
      const std::optional<double> cost = cost_at(beside);
      if (!cost || *cost >= least) continue;
      least = *cost;
      best = beside;
    }
  }
  return best;
}

LabelMover::Outcome LabelMover::relax(std::uint64_t vertex, std::span<const TetCorner> star) {
  const WorldPoint start = mesh_.stored_position(vertex);
  star_.gather(mesh_, star);
  const AngleRange before = star_.angles(start);
  if (goal_.met_by(before)) return {{}, true};
  const Meeting meeting = meeting_of(star, start);
  if (meeting.fixed || meeting.count == kMostMeeting) return {};
  const bool within_label = meeting.count < 2;
  if (!within_label && !projector_.enter(meeting.labels(), start)) return {};

  LabelGuide guide{projector_, within_label};
  const double spacing = mesh_.header.spacing;
  PlaceSearch search(star_, goal_, guide);
  if (!search.run({start, before_.stored_position(vertex), spacing, kReach * spacing, before,
                   limit_})) {
    return {};
  }
  return {search.place(), search.good()};
}

}  // namespace tet
