#include "core/image/header_numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/types.h"
#include "core/image/image_refusal.h"
#include "core/image/text_header.h"
#include "core/volume/check_transform.h"

namespace tet {

std::vector<std::string_view> words_of(std::string_view text,
                                       std::size_t most,
                                       const char* what) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (true) {
    while (at < text.size() && absl::ascii_isspace(static_cast<unsigned char>(text[at]))) ++at;
    if (at == text.size()) return words;
    std::size_t end = at;
    while (end < text.size() && !absl::ascii_isspace(static_cast<unsigned char>(text[end]))) {
      ++end;
    }
    if (words.size() == most) {
      refuse_image(absl::StrFormat("its %s has more than %d entries", what, most));
    }
    words.push_back(text.substr(at, end - at));
    at = end;
  }
}

double number_of(std::string_view text, const char* what) {
  double value = 0;
  if (!absl::SimpleAtod(as_absl(text), &value) || !std::isfinite(value)) {
    refuse_image(
        absl::StrCat("its ", what, " has ", quoted_text(text), ", which is no finite number"));
  }
  return value;
}

std::int64_t integer_of(std::string_view text, const char* what) {
  std::int64_t value = 0;
  if (!absl::SimpleAtoi(as_absl(text), &value)) {
    refuse_image(
        absl::StrCat("its ", what, " has ", quoted_text(text), ", which is no integer"));
  }
  return value;
}

Triple triple_of(std::string_view text, const char* what) {
  const auto words = words_of(text, 3, what);
  if (words.size() != 3) {
    refuse_image(absl::StrFormat("its %s has %d numbers and not 3", what, words.size()));
  }
  return {number_of(words[0], what), number_of(words[1], what), number_of(words[2], what)};
}

void set_size(const std::vector<std::int64_t>& sizes, ImageArray& array) {
  std::string all;
  for (const std::int64_t size : sizes) absl::StrAppend(&all, all.empty() ? "" : " x ", size);
  for (const std::int64_t size : sizes) {
    if (size < 1)
      refuse_image(absl::StrCat("its size is ", all, ": no axis may be that short"));
  }
  if (sizes.size() < 3) {
    refuse_contents(absl::StrCat("it is an image of ", sizes.size(), " dimensions (", all,
                                 "): stack its slices into one of 3"));
  }
  for (std::size_t i = 3; i < sizes.size(); ++i) {
    if (sizes[i] == 1) continue;
    refuse_contents(absl::StrCat("it is an image of more than 3 dimensions (", all,
                                 "): write one volume of it to a file of its own"));
  }
  // Dividing what is allowed, so that no product overflows.
  std::uint64_t most = kMostImageBytes / bytes_of(array.type);
  for (std::size_t i = 0; i < 3; ++i) {
    if (sizes[i] > kMaxVoxelCoord / 4 || static_cast<std::uint64_t>(sizes[i]) > most) {
      refuse_image(
          absl::StrFormat("its size is %s: more than %d voxels along an axis, or %d "
                          "bytes in all, are not read",
                          all, kMaxVoxelCoord / 4, kMostImageBytes));
    }
    most /= static_cast<std::uint64_t>(sizes[i]);
    array.size[i] = static_cast<std::int32_t>(sizes[i]);
  }
}

void set_axes(const std::array<Triple, 3>& axes, const Triple& origin, ImageArray& array) {
  VoxelTransform& transform = array.transform;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) transform.linear[row][axis] = axes[axis][row];
  }
  transform.translation = origin;
  transform.voxel_size = voxel_edge(transform);
  const absl::Status status = check_transform(transform);
  if (!status.ok()) throw ImageRefusal(status);
}

void check_claim(const ImageArray& array) {
  // Base64 takes four letters for three bytes.
  std::uint64_t most = array.bytes;
  switch (array.encoding) {
    case ImageEncoding::kRaw:
      break;
    case ImageEncoding::kText:
      most = (array.bytes + 1) / 2 * bytes_of(array.type);  // a digit and a blank
      break;
    case ImageEncoding::kDeflate:
      most = array.bytes * kMostExpansion;
      break;
    case ImageEncoding::kVtiBase64:
    case ImageEncoding::kVtiRaw:
      most = array.bytes * (array.blocks_deflated ? kMostExpansion : 1);
      break;
  }
  if (array.value_bytes() <= most) return;
  refuse_image(absl::StrFormat(
      "it is truncated: %d x %d x %d values of %s are claimed, and %d bytes hold fewer",
      array.size[0], array.size[1], array.size[2], scalar_name(array.type), array.bytes));
}

void check_data_end(const ImageArray& array, std::uint64_t file_bytes) {
  const std::uint64_t left = array.offset > file_bytes ? 0 : file_bytes - array.offset;
  if (left >= array.value_bytes()) return;
  refuse_image(absl::StrFormat(
      "it is truncated: %d x %d x %d values of %s take %d bytes, and %d follow the header",
      array.size[0], array.size[1], array.size[2], scalar_name(array.type), array.value_bytes(),
      left));
}

void set_attached_data(std::uint64_t header_end, std::uint64_t file_bytes, ImageArray& array) {
  array.offset = header_end;
  array.bytes = file_bytes - std::min(header_end, file_bytes);
  if (array.encoding == ImageEncoding::kRaw) {
    check_data_end(array, file_bytes);
    array.bytes = array.value_bytes();
  }
  check_claim(array);
}

}  // namespace tet
