// The rules of every request, in the words of the command line's options.
#pragma once

#include "client/command/arguments/mesh_input.h"
#include "core/plan/mesh_request.h"
#include "core/plan/request_rules.h"

namespace tet {

/// What the options call the features of a request, with the values that it has.
FeatureNames option_names(const MeshRequest& request);

/// The features of a request and of what it is about.
Features features_of(const MeshRequest& request, const MeshInput& input);

/// OK, or kInvalidArgument: what a server would say, before anything is sent.
absl::Status check_rules(const MeshRequest& request, const MeshInput& input);

}  // namespace tet
