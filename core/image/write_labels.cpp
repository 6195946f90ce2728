#include "core/image/write_labels.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/atomic_file.h"
#include "core/base/types.h"

namespace tet {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The three numbers of an axis, so that reading gives the same bits.
std::string vector_text(double x, double y, double z) {
  return absl::StrFormat("(%.17g,%.17g,%.17g)", x, y, z);
}

std::string header_of(const LabelVolume& labels, std::string_view type) {
  const VoxelBox& box = labels.box;
  const auto& m = labels.transform.linear;
  std::string text = absl::StrFormat(
      "NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nendian: little\nencoding: raw\n"
      "space dimension: 3\nspace directions:",
      type, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1, box.max.z - box.min.z + 1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    absl::StrAppend(&text, " ", vector_text(m[0][axis], m[1][axis], m[2][axis]));
  }
  const WorldPoint first =
      labels.transform.to_world({1.0 * box.min.x, 1.0 * box.min.y, 1.0 * box.min.z});
  absl::StrAppend(&text, "\nspace origin: ", vector_text(first.x, first.y, first.z), "\n\n");
  return text;
}

/// The voxels of one z, x fastest.
template <class T>
void gather_slice(const LabelVolume& labels, std::int32_t z, std::vector<T>& slice) {
  const VoxelBox& box = labels.box;
  slice.clear();
  for (std::int32_t y = box.min.y; y <= box.max.y; ++y) {
    for (std::int32_t x = box.min.x; x <= box.max.x; ++x) {
      slice.push_back(static_cast<T>(labels.labels[labels.at({x, y, z})]));
    }
  }
}

template <class T>
absl::Status write_as(const LabelVolume& labels, std::string_view type, AtomicFile& file) {
  const std::string header = header_of(labels, type);
  absl::Status status = file.write(std::as_bytes(std::span(header)));
  std::vector<T> slice;
  for (std::int32_t z = labels.box.min.z; status.ok() && z <= labels.box.max.z; ++z) {
    gather_slice(labels, z, slice);
    status = file.write(std::as_bytes(std::span(slice)));
  }
  return status;
}

absl::Status write_values(const LabelVolume& labels, AtomicFile& file) {
  const std::int64_t least = labels.labels.front(), greatest = labels.labels.back();
  const auto fits = [&]<class T>(std::type_identity<T>) {
    return std::in_range<T>(least) && std::in_range<T>(greatest);
  };
  if (fits(std::type_identity<std::uint8_t>())) {
    return write_as<std::uint8_t>(labels, "uint8", file);
  }
  if (fits(std::type_identity<std::uint16_t>())) {
    return write_as<std::uint16_t>(labels, "uint16", file);
  }
  if (fits(std::type_identity<std::int32_t>())) {
    return write_as<std::int32_t>(labels, "int32", file);
  }
  return write_as<std::int64_t>(labels, "int64", file);
}

}  // namespace

absl::Status write_labels(const LabelVolume& labels, const std::string& path) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = write_values(labels, *file); !status.ok()) return status;
  return file->commit();
}

}  // namespace tet
