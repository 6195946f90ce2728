// Labels as options: which of a segmentation are meshed, how, and what they are called.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/plan/label_choice.h"

namespace CLI {
class App;
}

namespace tet {

/// What a command line says of labels, before it is understood.
struct LabelArguments {
  std::string labels;  ///< empty: no labels are meshed
  std::vector<std::string> merges;
  std::string background;
  std::optional<std::int64_t> background_label;
  std::string names;               ///< a file
  std::string smooth;              ///< a number, or `thin`
  std::vector<std::string> sizes;  ///< `4,7:12=2.5`
};

/// Adds --labels, --merge, --background, --background-label, --label-names, --label-size and
/// --smooth.
void describe_labels(CLI::App& app, LabelArguments& arguments);

/// Understands what is asked for; it is nothing without --labels. Errors: kNotFound (no such
/// table), kInvalidArgument (with the option).
absl::StatusOr<std::optional<LabelChoice>> understand_labels(const LabelArguments& arguments);

}  // namespace tet
