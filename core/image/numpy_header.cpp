#include "core/image/numpy_header.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>

#include "core/image/binary_header.h"
#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/text_header.h"

namespace tet {
namespace {

constexpr std::string_view kNumpyMagic = "\x93NUMPY";

/// What follows `'key':` in the header's dictionary, up to `end`.
std::string_view value_of(std::string_view dictionary, std::string_view key, char end) {
  const std::string quoted = absl::StrCat("'", as_absl(key), "':");
  const std::size_t at = dictionary.find(quoted);
  const std::size_t stop =
      at == std::string_view::npos ? at : dictionary.find(end, at + quoted.size());
  if (stop == std::string_view::npos) {
    refuse_image(absl::StrCat("its header has no ", as_absl(key)));
  }
  const std::size_t from = at + quoted.size();
  return trimmed(dictionary.substr(from, stop - from));
}

void set_numpy_type(std::string_view descr, ImageArray& array) {
  struct Named {
    std::string_view name;
    ScalarType type;
  };
  constexpr Named kTypes[] = {
      {"b1", ScalarType::kUint8},   {"i1", ScalarType::kInt8},    {"u1", ScalarType::kUint8},
      {"i2", ScalarType::kInt16},   {"u2", ScalarType::kUint16},  {"i4", ScalarType::kInt32},
      {"u4", ScalarType::kUint32},  {"i8", ScalarType::kInt64},   {"u8", ScalarType::kUint64},
      {"f4", ScalarType::kFloat32}, {"f8", ScalarType::kFloat64},
  };
  const bool quoted = descr.size() == 5 && descr.front() == '\'' && descr.back() == '\'';
  if (quoted && std::string_view("<>|=").find(descr[1]) != std::string_view::npos) {
    for (const Named& known : kTypes) {
      if (descr.substr(2, 2) != known.name) continue;
      array.type = known.type;
      array.big_endian = descr[1] == '>';
      return;
    }
  }
  refuse_contents(absl::StrCat("its values are of the type ", quoted_text(descr),
                               ", and bool, integers of 8 to 64 bits, float32 and float64 are "
                               "read: use array.astype"));
}

std::vector<std::int64_t> numpy_shape(std::string_view text) {
  std::vector<std::int64_t> shape;
  for (const std::string_view part : split_text(text, ',', 64)) {
    const auto word = trimmed(part);
    if (word.empty()) continue;
    if (shape.size() == 32) refuse_image("its shape has more than 32 entries");
    shape.push_back(integer_of(word, "shape"));
  }
  if (shape.size() != 3) {
    refuse_contents(absl::StrCat("its shape is (", as_absl(text.substr(0, 60)),
                                 "), and an image has 3 axes: take one volume of it, as with "
                                 "array[0] or numpy.squeeze"));
  }
  return shape;
}

}  // namespace

bool is_numpy(std::span<const std::byte> head) noexcept {
  return head.size() >= kNumpyMagic.size() &&
         std::equal(kNumpyMagic.begin(), kNumpyMagic.end(), head.begin(),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

ImageOutline read_numpy_header(std::span<const std::byte> head, std::uint64_t file_bytes) {
  const BinaryHeader bytes(head, false);
  const auto version = bytes.at<std::uint8_t>(6);
  if (version < 1 || version > 3) {
    refuse_image(absl::StrFormat("its version is %d, and only 1 to 3 can be read", version));
  }
  const std::uint64_t from = version == 1 ? 10 : 12;
  const std::uint64_t length =
      version == 1 ? bytes.at<std::uint16_t>(8) : bytes.at<std::uint32_t>(8);
  if (length > kTextHeaderBytes || from + length > head.size()) {
    refuse_image("it is truncated, or its header is no header of an array of numbers");
  }
  const std::string_view dictionary(reinterpret_cast<const char*>(head.data()) + from, length);
  ImageArray array;
  array.name = "image";
  set_numpy_type(value_of(dictionary, "descr", ','), array);
  const std::string_view fortran = value_of(dictionary, "fortran_order", ',');
  if (fortran != "True" && fortran != "False") {
    refuse_image(absl::StrCat("its fortran_order is ", quoted_text(fortran)));
  }
  const std::string_view tuple = value_of(dictionary, "shape", ')');
  if (!tuple.starts_with('(')) refuse_image("its shape is no tuple");
  std::vector<std::int64_t> sizes = numpy_shape(tuple.substr(1));
  std::array<Triple, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (fortran == "False") {
    std::reverse(sizes.begin(), sizes.end());
    std::reverse(axes.begin(), axes.end());
  }
  set_size(sizes, array);
  set_axes(axes, {0, 0, 0}, array);
  array.offset = from + length;
  array.bytes = array.value_bytes();
  check_data_end(array, file_bytes);
  ImageOutline outline;
  outline.format = ImageFormat::kNumpy;
  outline.arrays.push_back(std::move(array));
  return outline;
}

}  // namespace tet
