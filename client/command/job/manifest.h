// Manifests: a file with a job on each line.
#pragma once

#include <istream>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/command/job/job_order.h"

namespace tet {

/// A line is the input and options, as on the command line,
///
///   bunny.vdb --levels 0 --label part=ear
///
/// or the same as one JSON object, for programs. Its keys are the options' names, with `_` or
/// `-`, and `input`; lists of numbers are options with several values, lists of texts are
/// options that are repeated, `label` is an object:
///
///   {"input": "bunny.vdb", "levels": 0, "improve": true, "label": {"part": "ear"}}
///   {"input": "fire.vdb", "grid": "density", "field": ["heat", "flow.vdb:velocity"]}
///
/// Empty lines and those that begin with # mean nothing. What a line does not say is as in
/// `defaults`; labels are added to those there.
///
/// Errors: kInvalidArgument, "NAME:LINE: why".
absl::StatusOr<std::vector<JobArguments>> read_manifest(std::istream& lines,
                                                        const std::string& name,
                                                        const JobArguments& defaults);

}  // namespace tet
