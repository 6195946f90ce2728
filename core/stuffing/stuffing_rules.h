// What a preset stands for.
#pragma once

namespace tet {

/// A cut point closer to a node than this share of its edge's length violates the node.
struct WarpLimits {
  float alpha_long = 0.25F;
  float alpha_short = 0.35F;

  friend bool operator==(const WarpLimits&, const WarpLimits&) = default;
};

struct StuffingRules {
  WarpLimits limits;
  bool both_sides = false;  ///< the outside is meshed too

  friend bool operator==(const StuffingRules&, const StuffingRules&) = default;
};

}  // namespace tet
