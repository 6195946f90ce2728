#include "proto/convert/face_labels.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/utf8.h"
#include "core/volume/grid_info.h"

namespace tet {
namespace {

absl::Status bad_labels(const std::string& message) {
  return absl::InvalidArgumentError(message);
}

/// A label's name is shown, and written into files. It may be a grid's and then a surface's.
bool is_label_name(const std::string& name) {
  constexpr std::size_t kMostBytes = kMaxGridNameBytes + 128;
  return !name.empty() && name.size() <= kMostBytes && is_utf8(name) &&
         std::ranges::none_of(name, [](unsigned char c) { return absl::ascii_iscntrl(c); });
}

absl::Status check_faces(const v1::MeshHeader& message) {
  constexpr std::int64_t kMostNarrow = std::numeric_limits<std::uint32_t>::max();
  if (message.face_labels().empty()) {
    if (message.face_count() == 0) return absl::OkStatus();
    return bad_labels(
        absl::StrFormat("face_count %d without face_labels", message.face_count()));
  }
  if (message.face_count() / 4 > message.tet_count()) {
    return bad_labels(absl::StrFormat("face_count %d is more than %d tets have",
                                      message.face_count(), message.tet_count()));
  }
  if (message.index_type() != v1::INDEX_TYPE_UINT64 && message.tet_count() > kMostNarrow) {
    return bad_labels("tets have no numbers of the index_type");
  }
  return absl::OkStatus();
}

}  // namespace

void to_proto(const FaceLabel& label, v1::FaceLabel& message) {
  message.set_name(label.name);
  message.set_kind(static_cast<v1::FaceKind>(label.kind));
  message.set_part(static_cast<std::int32_t>(label.part));
}

absl::StatusOr<std::vector<FaceLabel>> face_labels_of(const v1::MeshHeader& message) {
  if (auto status = check_faces(message); !status.ok()) return status;
  if (message.face_labels_size() > int{kMaxFaceLabels}) {
    return bad_labels(absl::StrFormat("face_labels has %d entries; the limit is %d",
                                      message.face_labels_size(), kMaxFaceLabels));
  }
  std::set<std::string> names;
  std::vector<FaceLabel> labels;
  for (const v1::FaceLabel& label : message.face_labels()) {
    const bool is_kind =
        label.kind() >= v1::FACE_KIND_SURFACE && label.kind() <= v1::FACE_KIND_REGION;
    const bool is_part = label.part() >= 0 && label.part() <= message.parts_size();
    if (!is_kind || !is_part || !is_label_name(label.name()) ||
        !names.insert(label.name()).second) {
      return bad_labels(
          absl::StrCat("face_labels[", labels.size(), "] is no label of its own"));
    }
    labels.push_back({label.name(), static_cast<FaceKind>(label.kind()),
                      static_cast<std::uint32_t>(label.part())});
  }
  return labels;
}

}  // namespace tet
