#include "proto/convert/labels_request.h"

#include <set>
#include <utility>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/status.h"

namespace tet {

namespace v1 = ::tetstream::v1;

namespace {

std::vector<LabelRange> ranges_of(
    const google::protobuf::RepeatedPtrField<v1::LabelRange>& messages) {
  std::vector<LabelRange> ranges;
  for (const v1::LabelRange& range : messages) ranges.push_back({range.first(), range.last()});
  return ranges;
}

void add_ranges(const std::vector<LabelRange>& ranges,
                google::protobuf::RepeatedPtrField<v1::LabelRange>& messages) {
  for (const LabelRange& range : ranges) {
    v1::LabelRange& added = *messages.Add();
    added.set_first(range.first);
    added.set_last(range.last);
  }
}

absl::StatusOr<LabelKernel> parse_kernel(v1::LabelKernel kernel) {
  switch (kernel) {
    case v1::LABEL_KERNEL_UNSPECIFIED:
    case v1::LABEL_KERNEL_GAUSS:
      return LabelKernel::kGauss;
    case v1::LABEL_KERNEL_QUADRATIC:
      return LabelKernel::kQuadratic;
    case v1::LABEL_KERNEL_TRILINEAR:
      return LabelKernel::kTrilinear;
    default:
      return invalid_field(
          absl::StrCat(kLabelsField, ".kernel ", static_cast<int>(kernel), " is unknown"));
  }
}

v1::LabelKernel kernel_message(LabelKernel kernel) {
  switch (kernel) {
    case LabelKernel::kGauss:
      return v1::LABEL_KERNEL_GAUSS;
    case LabelKernel::kQuadratic:
      return v1::LABEL_KERNEL_QUADRATIC;
    case LabelKernel::kTrilinear:
      return v1::LABEL_KERNEL_TRILINEAR;
  }
  return v1::LABEL_KERNEL_UNSPECIFIED;
}

absl::Status bad_header_label(std::size_t i, const char* what) {
  return absl::InvalidArgumentError(absl::StrFormat("labels[%d] %s", i, what));
}

absl::Status check_header_label(const v1::MeshLabel& label, std::size_t i) {
  if (!label.name().empty() && !is_label_name(label.name())) {
    return bad_header_label(i, "has a name that cannot be shown");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status parse_labels(const v1::MeshRequest& request, MeshRequest& out) {
  if (!request.has_labels()) return absl::OkStatus();
  const v1::Labels& message = request.labels();
  const absl::StatusOr<LabelKernel> kernel = parse_kernel(message.kernel());
  if (!kernel.ok()) return kernel.status();
  if (message.has_smooth() && *kernel != LabelKernel::kGauss) {
    return invalid_field(absl::StrFormat(
        "%s.smooth %g is the width of a Gaussian, and the kernel is another: leave it unset",
        kLabelsField, message.smooth()));
  }
  LabelChoice choice{.only = ranges_of(message.only()),
                     .background = message.background(),
                     .mesh_background = message.mesh_background(),
                     .kernel = *kernel};
  for (const v1::LabelMerge& merge : message.merges()) {
    choice.merges.push_back(ranges_of(merge.ranges()));
  }
  for (const v1::LabelName& name : message.names()) {
    choice.names.push_back({name.value(), name.name()});
  }
  if (message.has_smooth()) choice.smooth = message.smooth();
  for (const v1::LabelSize& size : message.sizes()) {
    choice.sizes.push_back({{size.labels().first(), size.labels().last()}, size.size()});
  }
  if (const auto status = check_label_choice(choice); !status.ok()) {
    return invalid_field(std::string(status.message()));
  }
  out.labels = std::move(choice);
  return absl::OkStatus();
}

v1::Labels message_of_labels(const LabelChoice& choice) {
  v1::Labels message;
  add_ranges(choice.only, *message.mutable_only());
  for (const LabelMerge& merge : choice.merges) {
    add_ranges(merge, *message.add_merges()->mutable_ranges());
  }
  message.set_background(choice.background);
  message.set_mesh_background(choice.mesh_background);
  for (const LabelName& name : choice.names) {
    v1::LabelName& added = *message.add_names();
    added.set_value(name.value);
    added.set_name(name.name);
  }
  message.set_kernel(kernel_message(choice.kernel));
  if (choice.kernel == LabelKernel::kGauss) message.set_smooth(choice.smooth);
  for (const LabelSize& size : choice.sizes) {
    v1::LabelSize& added = *message.add_sizes();
    added.mutable_labels()->set_first(size.labels.first);
    added.mutable_labels()->set_last(size.labels.last);
    added.set_size(size.size);
  }
  return message;
}

std::string exact_labels(const v1::MeshRequest& request) {
  if (!request.has_labels()) return "";
  return absl::StrCat(" labels ", absl::BytesToHexString(request.labels().SerializeAsString()));
}

void to_proto(const MeshLabel& label, v1::MeshLabel& message) {
  message.set_value(label.value);
  message.set_name(label.name);
}

absl::StatusOr<std::vector<MeshLabel>> labels_of(const v1::MeshHeader& message) {
  if (static_cast<std::size_t>(message.labels_size()) > kMaxMeshLabels) {
    return absl::InvalidArgumentError(absl::StrFormat("labels has %d entries; the limit is %d",
                                                      message.labels_size(), kMaxMeshLabels));
  }
  if (!message.labels().empty() && (message.has_regions() || !message.parts().empty())) {
    return absl::InvalidArgumentError("labels stand beside regions or parts");
  }
  std::set<std::int64_t> values;
  std::vector<MeshLabel> labels;
  for (const v1::MeshLabel& label : message.labels()) {
    if (auto s = check_header_label(label, labels.size()); !s.ok()) return s;
    if (!values.insert(label.value()).second) {
      return bad_header_label(labels.size(), "is there twice");
    }
    labels.push_back({label.value(), label.name()});
  }
  return labels;
}

}  // namespace tet
