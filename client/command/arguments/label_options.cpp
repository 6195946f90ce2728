#include "client/command/arguments/label_options.h"

#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>

#include "client/command/process/interruption.h"
#include "client/library/label_table.h"
#include "client/library/text_file.h"

namespace tet {
namespace {

absl::Status understand_smooth(const std::string& text, LabelChoice& choice) {
  if (text.empty()) return absl::OkStatus();
  if (text == "thin") {
    choice.kernel = LabelKernel::kQuadratic;
    return absl::OkStatus();
  }
  double width = 0;
  if (!absl::SimpleAtod(text, &width) || !(width >= 0 && width <= kMostSmooth)) {
    return absl::InvalidArgumentError(absl::StrCat("--smooth ", text, " is neither from 0 to ",
                                                   kMostSmooth, " voxels nor `thin`"));
  }
  if (width == 0) {
    choice.kernel = LabelKernel::kTrilinear;
  } else {
    choice.smooth = width;
  }
  return absl::OkStatus();
}

absl::Status understand_ranges(const LabelArguments& arguments, LabelChoice& choice) {
  absl::StatusOr<std::vector<LabelRange>> only = parse_label_ranges(arguments.labels);
  if (!only.ok()) return about("--labels", only.status());
  choice.only = *std::move(only);
  for (const std::string& text : arguments.merges) {
    absl::StatusOr<LabelMerge> merge = parse_label_ranges(text);
    if (!merge.ok()) return about("--merge", merge.status());
    if (merge->empty()) {
      return absl::InvalidArgumentError(
          "--merge all would leave one label: mesh the image at an iso value (--iso)");
    }
    choice.merges.push_back(*std::move(merge));
  }
  return absl::OkStatus();
}

/// Reads `4,7:12=2.5`, or `all=2.5`.
absl::Status understand_size(const std::string& text, LabelChoice& choice) {
  const std::size_t equals = text.rfind('=');
  double size = 0;
  if (equals == std::string::npos || !absl::SimpleAtod(text.substr(equals + 1), &size)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--label-size ", text, " is no size of labels: it takes labels and a length, such as ",
        "4,7:12=2.5, or all=2.5"));
  }
  absl::StatusOr<std::vector<LabelRange>> labels = parse_label_ranges(text.substr(0, equals));
  if (!labels.ok()) return about("--label-size", labels.status());
  if (labels->empty()) labels->push_back(kEveryLabel);
  for (const LabelRange& range : *labels) choice.sizes.push_back({range, size});
  return absl::OkStatus();
}

absl::Status read_names(const std::string& path, LabelChoice& choice) {
  if (path.empty()) return absl::OkStatus();
  const absl::StatusOr<std::string> text = read_text_file(path, user_interruption());
  if (!text.ok()) return text.status();
  absl::StatusOr<std::vector<LabelName>> names = parse_label_table(*text);
  if (!names.ok()) return about(path, names.status());
  choice.names = *std::move(names);
  return absl::OkStatus();
}

}  // namespace

void describe_labels(CLI::App& app, LabelArguments& arguments) {
  auto* const labels =
      app.add_option("--labels", arguments.labels,
                     "Mesh all labels of a segmentation, or 1,4,7:12, in one mesh with shared "
                     "interfaces; with --all-grids, or several --grid, each level set is "
                     "one, and each part of a scene: docs/labels.md")
          ->type_name("all|LIST");
  app.add_option("--merge", arguments.merges,
                 "Labels that become one, the first of them; may be repeated")
      ->type_name("LIST")
      ->allow_extra_args(false)
      ->needs(labels);
  app.add_option("--background", arguments.background,
                 "The space around labels: left-out, or meshed up to the box [left-out]")
      ->check(CLI::IsMember({"left-out", "meshed"}))
      ->needs(labels);
  app.add_option("--background-label", arguments.background_label,
                 "The label that is the background, and what lies beyond the image [0]")
      ->needs(labels);
  app.add_option("--label-names", arguments.names,
                 "What labels are called: a table of ITK-SNAP, 3D Slicer (.ctbl) or JSON")
      ->type_name("FILE")
      ->needs(labels);
  app.add_option("--label-size", arguments.sizes,
                 "Leaves of these labels are at most so long, and those of others as coarse "
                 "as --levels says, or can be; may be repeated")
      ->type_name("LIST=SIZE")
      ->allow_extra_args(false)
      ->needs(labels);
  app.add_option(
         "--smooth", arguments.smooth,
         "How interfaces are smoothed: the width of a Gaussian in voxels; 0 keeps every "
         "stair; thin keeps sheets one voxel thin [0.7]")
      ->type_name("VOXELS|thin")
      ->needs(labels);
}

absl::StatusOr<std::optional<LabelChoice>> understand_labels(const LabelArguments& arguments) {
  if (arguments.labels.empty()) return std::nullopt;
  LabelChoice choice;
  absl::Status status = understand_ranges(arguments, choice);
  if (status.ok()) status = understand_smooth(arguments.smooth, choice);
  if (status.ok()) status = read_names(arguments.names, choice);
  for (const std::string& size : arguments.sizes) {
    if (status.ok()) status = understand_size(size, choice);
  }
  choice.mesh_background = arguments.background == "meshed";
  choice.background = arguments.background_label.value_or(0);
  if (status.ok()) status = check_label_choice(choice);
  if (!status.ok()) return status;
  return choice;
}

}  // namespace tet
