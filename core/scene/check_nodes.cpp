#include "core/scene/check_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/string_view.h>

#include "core/scene/scene.h"

namespace tet::scene {
namespace {

/// Lengths beyond these are no world's, and their squares would leave a double's range.
constexpr double kMaxLength = 1e15, kMinLength = 1e-15;

/// Collects what is wrong with one node; the first complaint stays.
class Complaints {
 public:
  explicit Complaints(std::string path) : path_(std::move(path)) {}

  void positive(absl::string_view field, double value) {
    if (value >= kMinLength && value <= kMaxLength) return;
    say(field, absl::StrFormat("%g is not from %g to %g", value, kMinLength, kMaxLength));
  }
  void not_negative(absl::string_view field, double value) {
    if (value == 0 || (value >= kMinLength && value <= kMaxLength)) return;
    say(field,
        absl::StrFormat("%g is neither 0 nor from %g to %g", value, kMinLength, kMaxLength));
  }
  void finite(absl::string_view field, double value) {
    if (std::abs(value) <= kMaxLength) return;
    say(field, absl::StrFormat("%g is not from %g to %g", value, -kMaxLength, kMaxLength));
  }
  void positive(absl::string_view field, const Triple& values) {
    for (std::size_t i = 0; i < 3; ++i) positive(absl::StrCat(field, "[", i, "]"), values[i]);
  }
  void finite(absl::string_view field, const Triple& values) {
    for (std::size_t i = 0; i < 3; ++i) finite(absl::StrCat(field, "[", i, "]"), values[i]);
  }
  void direction(absl::string_view field, const Triple& values) {
    finite(field, values);
    const double length = std::hypot(values[0], values[1], values[2]);
    if (!(length >= kMinLength)) say(field, "has no direction: all three numbers are 0");
  }
  void say(absl::string_view field, absl::string_view what) {
    if (status_.ok()) {
      status_ = absl::InvalidArgumentError(absl::StrCat(path_, ".", field, " ", what));
    }
  }
  const absl::Status& status() const { return status_; }

 private:
  std::string path_;
  absl::Status status_;
};

void check(const std::monostate&, Complaints&) {}

void check(const Sphere& s, Complaints& is) { is.positive("radius", s.radius); }

void check(const Ellipsoid& e, Complaints& is) { is.positive("semi_axes", e.semi_axes); }

void check(const RoundedBox& b, Complaints& is) {
  is.positive("size", b.size);
  is.not_negative("rounding", b.rounding);
  const double most = std::min({b.size[0], b.size[1], b.size[2]}) / 2;
  if (b.rounding > most) {
    is.say("rounding",
           absl::StrFormat("%g is more than half the shortest edge, %g", b.rounding, most));
  }
}

void check(const Cylinder& c, Complaints& is) {
  is.positive("radius", c.radius);
  is.positive("height", c.height);
}

void check(const Cone& c, Complaints& is) {
  is.not_negative("bottom_radius", c.bottom_radius);
  is.not_negative("top_radius", c.top_radius);
  is.positive("height", c.height);
  if (c.bottom_radius == 0 && c.top_radius == 0) {
    is.say("bottom_radius", "and top_radius are both 0: one may be");
  }
}

void check(const Torus& t, Complaints& is) {
  is.positive("major_radius", t.major_radius);
  is.positive("minor_radius", t.minor_radius);
}

void check(const Capsule& c, Complaints& is) {
  is.positive("radius", c.radius);
  is.not_negative("length", c.length);
}

void check(const HalfSpace& h, Complaints& is) {
  is.direction("normal", h.normal);
  is.finite("offset", h.offset);
}

void check(const PeriodicSurface& p, Complaints& is) {
  is.positive("period", p.period);
  if (p.thickness) is.positive("thickness", *p.thickness);
}

void check(const Combination& c, Complaints& is) {
  is.not_negative("smoothing", c.smoothing);
  if (c.of.empty()) is.say("of", "names no nodes");
  if (c.of.size() > Scene::kMaxInstructions) {
    is.say("of", absl::StrCat("names ", c.of.size(), " nodes; the limit is ",
                              Scene::kMaxInstructions));
  }
}

void check(const Offset& o, Complaints& is) { is.finite("distance", o.distance); }

void check(const Shell& s, Complaints& is) { is.positive("thickness", s.thickness); }

void check(const Transform& t, Complaints& is) {
  is.positive("scale", t.scale);
  is.direction("axis", t.axis);
  is.finite("angle_deg", t.angle_deg);
  is.finite("translation", t.translation);
}

void check(const Repeat& r, Complaints& is) {
  is.finite("step", r.step);
  for (std::size_t i = 0; i < 3; ++i) {
    if (r.count[i] < 1)
      is.say(absl::StrCat("count[", i, "]"), absl::StrCat(r.count[i], " is below 1"));
    if (r.count[i] > 1 && r.step[i] == 0) {
      is.say(absl::StrCat("step[", i, "]"),
             absl::StrCat("0 would put ", r.count[i], " copies in one place"));
    }
  }
}

void check(const GridSolid& g, Complaints& is) {
  if (g.iso) is.finite("iso", *g.iso);
}

absl::string_view kind_name(const PeriodicSurface& p) {
  constexpr std::array<absl::string_view, 3> kNames{"gyroid", "schwarz_p", "diamond"};
  return kNames[static_cast<std::size_t>(p.kind)];
}

absl::string_view kind_name(const Combination& c) {
  constexpr std::array<absl::string_view, 3> kNames{"union", "intersection", "difference"};
  return kNames[static_cast<std::size_t>(c.how)];
}

absl::string_view kind_name(const Node& node) {
  if (const auto* periodic = std::get_if<PeriodicSurface>(&node.kind))
    return kind_name(*periodic);
  if (const auto* combination = std::get_if<Combination>(&node.kind)) {
    return kind_name(*combination);
  }
  constexpr std::array<absl::string_view, std::variant_size_v<decltype(Node::kind)>> kNames{
      "",           "sphere",    "ellipsoid", "rounded_box",
      "cylinder",   "cone",      "torus",     "capsule",
      "half_space", "",          "",          "offset",
      "shell",      "transform", "repeat",    "grid"};
  return kNames[node.kind.index()];
}

/// Names of the nodes that a node is made of.
std::span<const std::string> names_in(const Node& node) {
  return std::visit(
      [](const auto& kind) -> std::span<const std::string> {
        if constexpr (requires { kind.of.front().front(); }) {
          return kind.of;
        } else if constexpr (requires { kind.of; }) {
          return {&kind.of, 1};
        } else {
          return {};
        }
      },
      node.kind);
}

/// A name as a message quotes it.
std::string in_quotes(absl::string_view name) {
  return absl::StrCat("\"", name.substr(0, Scene::kMaxNameBytes), "\"");
}

/// Nodes by name, as far as they have been seen.
class Names {
 public:
  explicit Names(const Description& description) : description_(description) {}

  absl::Status add(std::uint32_t node) {
    const std::string& name = description_.nodes[node].name;
    if (name.size() > Scene::kMaxNameBytes) {
      return absl::InvalidArgumentError(absl::StrCat("nodes[", node, "].name has ", name.size(),
                                                     " bytes; the limit is ",
                                                     Scene::kMaxNameBytes));
    }
    if (name.empty() || places_.try_emplace(name, node).second) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat("nodes[", node, "].name ", in_quotes(name),
                                                   " is taken by nodes[", places_[name], "]"));
  }

  /// The nodes that a later one names.
  absl::StatusOr<std::vector<std::uint32_t>> find(std::uint32_t node) const {
    std::vector<std::uint32_t> found;
    for (const std::string& name : names_in(description_.nodes[node])) {
      const auto place = places_.find(name);
      if (place == places_.end()) return unknown(node, found.size(), name);
      found.push_back(place->second);
    }
    return found;
  }

 private:
  absl::Status unknown(std::uint32_t node, std::size_t at, const std::string& name) const {
    const bool many = std::holds_alternative<Combination>(description_.nodes[node].kind);
    return absl::InvalidArgumentError(
        absl::StrCat(path_of(description_, node), ".of", many ? absl::StrCat("[", at, "]") : "",
                     " ", in_quotes(name), " is not the name of an earlier node"));
  }

  const Description& description_;
  std::map<std::string, std::uint32_t> places_;
};

absl::Status check_count(const Description& description) {
  if (description.nodes.empty()) return absl::InvalidArgumentError("nodes is empty");
  if (description.nodes.size() <= Scene::kMaxNodes) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("nodes has ", description.nodes.size(),
                                                 " entries; the limit is ", Scene::kMaxNodes));
}

absl::Status check_depth(const Description& description, const Parts& parts) {
  std::vector<int> depth(parts.size(), 1);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const std::uint32_t part : parts[i]) depth[i] = std::max(depth[i], depth[part] + 1);
    if (depth[i] <= Scene::kMaxDepth) continue;
    return absl::InvalidArgumentError(absl::StrFormat("%s is %d nodes deep; the limit is %d",
                                                      path_of(description, i), depth[i],
                                                      Scene::kMaxDepth));
  }
  return absl::OkStatus();
}

/// A node that nothing uses is most likely a slip of the pen.
absl::Status check_used(const Description& description, const Parts& parts) {
  std::vector<bool> used(parts.size(), false);
  used.back() = true;
  for (const auto& of_node : parts) {
    for (const std::uint32_t part : of_node) used[part] = true;
  }
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused == used.end()) return absl::OkStatus();
  const auto at = static_cast<std::size_t>(unused - used.begin());
  return absl::InvalidArgumentError(
      absl::StrCat(path_of(description, at),
                   " is used by no later node, and only the last one may be: it is the scene"));
}

}  // namespace

std::string path_of(const Description& description, std::size_t node) {
  return absl::StrCat("nodes[", node, "].", kind_name(description.nodes[node]));
}

absl::Status check_sizes(const Description& description) {
  if (auto status = check_count(description); !status.ok()) return status;
  for (std::size_t i = 0; i < description.nodes.size(); ++i) {
    const Node& node = description.nodes[i];
    if (std::holds_alternative<std::monostate>(node.kind)) {
      return absl::InvalidArgumentError(
          absl::StrCat("nodes[", i, "] is of no kind: set sphere, union or another"));
    }
    Complaints complaints(path_of(description, i));
    std::visit([&](const auto& kind) { check(kind, complaints); }, node.kind);
    if (!complaints.status().ok()) return complaints.status();
  }
  return absl::OkStatus();
}

absl::StatusOr<Parts> find_parts(const Description& description) {
  Names names(description);
  Parts parts;
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i) {
    auto found = names.find(i);
    if (!found.ok()) return found.status();
    parts.push_back(*std::move(found));
    if (auto status = names.add(i); !status.ok()) return status;
  }
  if (auto status = check_depth(description, parts); !status.ok()) return status;
  if (auto status = check_used(description, parts); !status.ok()) return status;
  return parts;
}

}  // namespace tet::scene
