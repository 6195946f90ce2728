#include "core/image/place_array.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/byte_source.h"
#include "core/base/posix/file.h"
#include "core/image/image_refusal.h"
#include "core/image/outline_image.h"

namespace tet {
namespace {

absl::Status check_place(const ArrayPlace& place) {
  std::string sorted = place.axes;
  std::ranges::sort(sorted);
  if (sorted != "xyz") {
    return absl::InvalidArgumentError(
        absl::StrCat("axes ", place.axes, " is no order of x, y and z, as zyx is"));
  }
  if (!place.space.empty() && place.space != "RAS" && place.space != "LPS") {
    return absl::InvalidArgumentError(
        absl::StrCat("space ", place.space, " is neither RAS nor LPS"));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::isnormal(place.spacing[i]) && std::isfinite(place.origin[i])) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("spacing %g and origin %g are no place along an axis", place.spacing[i],
                        place.origin[i]));
  }
  return absl::OkStatus();
}

const char* nrrd_name(ScalarType type) {
  switch (type) {
    case ScalarType::kFloat32:
      return "float";
    case ScalarType::kFloat64:
      return "double";
    default:
      return scalar_name(type);
  }
}

/// The world's axis that an axis of the file runs along. An outline's axes are the array's
/// indices, in the order in which they run.
std::size_t world_axis(const ImageArray& array,
                       std::size_t file_axis,
                       const ArrayPlace& place) {
  std::size_t index = 0;
  while (array.transform.linear[index][file_axis] == 0) ++index;
  return static_cast<std::size_t>(place.axes[index] - 'x');
}

std::string header_of(const ImageArray& array, const ArrayPlace& place) {
  std::string text =
      absl::StrCat("NRRD0004\ntype: ", nrrd_name(array.type), "\ndimension: 3\nsizes:");
  for (const std::int32_t size : array.size) absl::StrAppend(&text, " ", size);
  absl::StrAppend(&text, "\nendian: ", array.big_endian ? "big" : "little", "\nencoding: raw\n",
                  place.space.empty()    ? "space dimension: 3"
                  : place.space == "RAS" ? "space: right-anterior-superior"
                                         : "space: left-posterior-superior",
                  "\nspace directions:");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Triple step{};
    const std::size_t along = world_axis(array, axis, place);
    step[along] = place.spacing[along];
    absl::StrAppendFormat(&text, " (%.17g,%.17g,%.17g)", step[0], step[1], step[2]);
  }
  absl::StrAppendFormat(&text, "\nspace origin: (%.17g,%.17g,%.17g)\n\n", place.origin[0],
                        place.origin[1], place.origin[2]);
  return text;
}

absl::Status copy_values(const File& from, const ImageArray& array, File& to) {
  std::vector<char> buffer(std::size_t{1} << 20);
  for (std::uint64_t done = 0; done < array.bytes;) {
    const auto piece =
        static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), array.bytes - done));
    const auto count = from.read_at(array.offset + done, std::span(buffer).first(piece));
    if (!count.ok()) return count.status();
    if (*count == 0) return absl::InvalidArgumentError("it is cut while it is read");
    if (auto s = to.append(std::string_view(buffer.data(), *count)); !s.ok()) return s;
    done += *count;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status place_array(const std::string& array,
                         const ArrayPlace& place,
                         const std::string& image) {
  if (absl::Status s = check_place(place); !s.ok()) return s;
  const absl::StatusOr<File> from = File::open(array, O_RDONLY, io_error);
  if (!from.ok()) return from.status();
  const auto size = from->size();
  if (!size.ok()) return size.status();
  const auto outline = outline_image(ByteSource(from->descriptor().number(), *size));
  if (!outline.ok()) return outline.status();
  if (outline->format != ImageFormat::kNumpy) {
    return absl::InvalidArgumentError("it is no array of NumPy");
  }
  absl::StatusOr<File> to = File::open(image, O_WRONLY | O_CREAT | O_EXCL, io_error);
  if (!to.ok()) return to.status();
  const ImageArray& values = outline->arrays.front();
  absl::Status status = to->append(header_of(values, place));
  if (status.ok()) status = copy_values(*from, values, *to);
  return status.ok() ? to->close() : status;
}

}  // namespace tet
