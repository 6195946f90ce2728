// The features that a message asks for, checked against the one table of what excludes what.
#pragma once

#include <absl/status/status.h>

#include "core/plan/request_rules.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// The message may be hostile: its numbers need not have been checked.
Features features_of(const v1::MeshRequest& request);
Features features_of(const v1::StreamMeshRequest& request);

/// As the service calls the features, with the values that the message has.
FeatureNames names_in(const v1::MeshRequest& request);

/// OK, or INVALID_FIELD with the message of the rule that is broken. `asked_by` is how the mesh
/// is asked for, beside the message.
absl::Status check_rules(const v1::MeshRequest& request, Features asked_by = {});
absl::Status check_rules(const v1::StreamMeshRequest& request);

}  // namespace tet
