// Tables that say what the labels of a segmentation are called.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/plan/label_choice.h"

namespace tet {

/// Names from the text of a table, told by what is in it:
///
/// - ITK-SNAP's label descriptions: `7 255 0 0 1 1 1 "bone"`
/// - colour tables of 3D Slicer (.ctbl) and FreeSurfer: `7 bone 255 0 0 255`
/// - JSON: `{"7": "bone"}`, or `[{"value": 7, "name": "bone"}]`
///
/// Errors: kInvalidArgument, with the line and what it takes.
absl::StatusOr<std::vector<LabelName>> parse_label_table(const std::string& text);

}  // namespace tet
