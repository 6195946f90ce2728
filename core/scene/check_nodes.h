// What can be wrong with a scene's nodes, one by one and together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/scene/scene_nodes.h"

namespace tet::scene {

/// Parts of each node, by their places in the description.
using Parts = std::vector<std::vector<std::uint32_t>>;

/// `nodes[3].torus`: how messages name a node and its kind.
std::string path_of(const Description& description, std::size_t node);

/// There are nodes, not too many, each of some kind; their sizes are positive and finite, and
/// agree with each other. Error: kInvalidArgument.
absl::Status check_sizes(const Description& description);

/// Follows names to earlier nodes. Errors: kInvalidArgument (a name that is taken, unknown or
/// of a later node, a node that is not used, or too many of them on one way).
absl::StatusOr<Parts> find_parts(const Description& description);

}  // namespace tet::scene
