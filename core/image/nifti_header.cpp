#include "core/image/nifti_header.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <absl/strings/str_format.h>

#include "core/image/binary_header.h"
#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"

namespace tet {
namespace {

constexpr std::int32_t kSizeOfFirst = 348, kSizeOfSecond = 540;

/// Where the fields of the two versions are.
struct Places {
  std::size_t magic, datatype, bitpix, dim, pixdim, vox_offset, slope, intercept, qform_code,
      quatern, srow, units;
  bool second;
};
constexpr Places kFirst{344, 70, 72, 40, 76, 108, 112, 116, 252, 256, 280, 123, false};
constexpr Places kSecond{4, 12, 14, 16, 104, 168, 176, 184, 344, 352, 400, 500, true};

bool has_text(std::span<const std::byte> head, std::size_t at, std::string_view text) {
  return head.size() >= at + text.size() &&
         std::equal(text.begin(), text.end(), head.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

/// The version and the order of bytes, by the header's own size.
struct Kind {
  const Places* places;
  bool big_endian;
};

std::optional<Kind> kind_of(std::span<const std::byte> head) {
  if (head.size() < static_cast<std::size_t>(kSizeOfFirst)) return std::nullopt;
  for (const bool big : {false, true}) {
    const auto size = BinaryHeader(head, big).at<std::int32_t>(0);
    if (size == kSizeOfFirst) return Kind{&kFirst, big};
    if (size == kSizeOfSecond) return Kind{&kSecond, big};
  }
  return std::nullopt;
}

ScalarType type_of(std::int32_t code) {
  switch (code) {
    case 2:
      return ScalarType::kUint8;
    case 4:
      return ScalarType::kInt16;
    case 8:
      return ScalarType::kInt32;
    case 16:
      return ScalarType::kFloat32;
    case 64:
      return ScalarType::kFloat64;
    case 256:
      return ScalarType::kInt8;
    case 512:
      return ScalarType::kUint16;
    case 768:
      return ScalarType::kUint32;
    case 1024:
      return ScalarType::kInt64;
    case 1280:
      return ScalarType::kUint64;
    default:
      break;
  }
  const bool colours = code == 128 || code == 2304, complex = code == 32 || code >= 1792;
  refuse_contents(absl::StrFormat(
      "its values are of NIfTI's type %d (%s), and only integers of 8 to 64 bits, float32 and "
      "float64 are read: write one number a voxel",
      code,
      colours   ? "colours"
      : complex ? "complex or long numbers"
                : "no type that is known"));
}

/// Reads one header, whichever of the two it is.
class Reader {
 public:
  Reader(std::span<const std::byte> head, const Kind& kind)
      : at_(*kind.places), big_endian_(kind.big_endian), header_(head, kind.big_endian) {}

  ImageOutline read(std::uint64_t file_bytes) {
    ImageOutline outline;
    outline.format = ImageFormat::kNifti;
    ImageArray array;
    array.name = "image";
    array.type = type_of(header_.at<std::int16_t>(at_.datatype));
    array.big_endian = big_endian_;
    const auto bits = header_.at<std::int16_t>(at_.bitpix);
    if (bits != static_cast<std::int32_t>(8 * bytes_of(array.type))) {
      refuse_image(absl::StrFormat("its values of %s are said to have %d bits",
                                   scalar_name(array.type), bits));
    }
    set_size(sizes(), array);
    read_scaling(array);
    read_axes(array, outline.space);
    array.offset = data_offset();
    array.bytes = array.value_bytes();
    check_data_end(array, file_bytes);
    outline.arrays.push_back(std::move(array));
    return outline;
  }

 private:
  double real(std::size_t first, std::size_t index) const {
    return at_.second ? header_.at<double>(first + 8 * index)
                      : static_cast<double>(header_.at<float>(first + 4 * index));
  }
  double finite(std::size_t first, std::size_t index, const char* what) const {
    const double value = real(first, index);
    if (!std::isfinite(value)) {
      refuse_image(absl::StrFormat("its %s is %g, which is not finite", what, value));
    }
    return value;
  }
  std::int64_t dimension(std::size_t index) const {
    return at_.second ? header_.at<std::int64_t>(at_.dim + 8 * index)
                      : std::int64_t{header_.at<std::int16_t>(at_.dim + 2 * index)};
  }
  std::int32_t code(std::size_t first, std::size_t index) const {
    return at_.second ? header_.at<std::int32_t>(first + 4 * index)
                      : std::int32_t{header_.at<std::int16_t>(first + 2 * index)};
  }

  std::vector<std::int64_t> sizes() const {
    const std::int64_t count = dimension(0);
    if (count < 1 || count > 7) {
      refuse_image(absl::StrFormat("it has %d dimensions, and NIfTI has 1 to 7", count));
    }
    std::vector<std::int64_t> sizes;
    for (std::int64_t i = 1; i <= count; ++i) {
      sizes.push_back(dimension(static_cast<std::size_t>(i)));
    }
    return sizes;
  }

  std::uint64_t data_offset() const {
    const double offset = at_.second
                              ? static_cast<double>(header_.at<std::int64_t>(at_.vox_offset))
                              : finite(at_.vox_offset, 0, "vox_offset");
    const double least = at_.second ? 544 : 352;
    // Zero means the least one in files of some writers.
    if (offset == 0) return static_cast<std::uint64_t>(least);
    if (!(offset >= least) || offset > 1e15 || offset != std::floor(offset)) {
      refuse_image(
          absl::StrFormat("its data begin at byte %g; they may from %g on", offset, least));
    }
    return static_cast<std::uint64_t>(offset);
  }

  /// A slope of 0, or one that is no number, says that there is none.
  void read_scaling(ImageArray& array) const {
    const double slope = real(at_.slope, 0), intercept = real(at_.intercept, 0);
    if (slope == 0 || !std::isfinite(slope)) return;
    if (!std::isfinite(intercept)) {
      refuse_image(absl::StrFormat("its scl_inter is %g, which is not finite", intercept));
    }
    array.slope = slope;
    array.intercept = intercept;
  }

  /// The sform goes before the qform, as in nibabel, ITK and FSL; without either only the sizes
  /// of voxels are known.
  void read_axes(ImageArray& array, ImageSpace& space) const {
    const std::int32_t units = at_.second ? header_.at<std::int32_t>(at_.units)
                                          : std::int32_t{header_.at<std::uint8_t>(at_.units)};
    switch (units & 7) {
      case 1:
        space.unit = "m";
        break;
      case 2:
        space.unit = "mm";
        break;
      case 3:
        space.unit = "um";
        break;
      default:
        break;
    }
    if (code(at_.qform_code, 1) > 0) {
      space.axes = "RAS";
      return read_sform(array);
    }
    if (code(at_.qform_code, 0) > 0) {
      space.axes = "RAS";
      return read_qform(array);
    }
    space.note = "it has neither sform nor qform: voxel (0, 0, 0) is put at the origin";
    const Triple edge = edges();
    set_axes({{{edge[0], 0, 0}, {0, edge[1], 0}, {0, 0, edge[2]}}}, {0, 0, 0}, array);
  }

  Triple edges() const {
    Triple edges{};
    for (std::size_t i = 0; i < 3; ++i) {
      edges[i] = finite(at_.pixdim, i + 1, "pixdim");
      if (edges[i] > 0) continue;
      refuse_image(absl::StrFormat("its voxels are %g long along axis %d", edges[i], i));
    }
    return edges;
  }

  void read_sform(ImageArray& array) const {
    std::array<Triple, 3> axes{};
    Triple origin{};
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        axes[column][row] = finite(at_.srow, 4 * row + column, "sform");
      }
      origin[row] = finite(at_.srow, 4 * row + 3, "sform");
    }
    set_axes(axes, origin, array);
  }

  /// A unit quaternion, of which a is left out; pixdim[0] says whether the third axis is turned
  /// round.
  void read_qform(ImageArray& array) const {
    constexpr double kRounding = 1e-5;
    const double b = finite(at_.quatern, 0, "qform"), c = finite(at_.quatern, 1, "qform"),
                 d = finite(at_.quatern, 2, "qform");
    const double rest = 1 - (b * b + c * c + d * d);
    if (rest < -kRounding) {
      refuse_image(
          absl::StrFormat("its qform has the quaternion (%g, %g, %g), which is longer "
                          "than 1",
                          b, c, d));
    }
    const double a = std::sqrt(std::max(rest, 0.0));
    const Triple edge = edges();
    const double third = finite(at_.pixdim, 0, "pixdim") < 0 ? -edge[2] : edge[2];
    const Triple x{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)};
    const Triple y{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)};
    const Triple z{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c};
    const auto times = [](const Triple& v, double by) {
      return Triple{by * v[0], by * v[1], by * v[2]};
    };
    set_axes({times(x, edge[0]), times(y, edge[1]), times(z, third)},
             {finite(at_.quatern, 3, "qform"), finite(at_.quatern, 4, "qform"),
              finite(at_.quatern, 5, "qform")},
             array);
  }

  const Places& at_;
  const bool big_endian_;
  const BinaryHeader header_;
};

}  // namespace

bool is_nifti(std::span<const std::byte> head) noexcept {
  return head.size() >= 4 &&
         (std::to_integer<int>(head[0]) == 0x5c || std::to_integer<int>(head[0]) == 0x1c ||
          std::to_integer<int>(head[0]) == 0) &&
         kind_of(head).has_value();
}

ImageOutline read_nifti_header(std::span<const std::byte> head, std::uint64_t file_bytes) {
  const std::optional<Kind> kind = kind_of(head);
  if (!kind) refuse_image("it is truncated: it ends within its header");
  const std::size_t magic = kind->places->magic;
  const char version = kind->places->second ? '2' : '1';
  if (has_text(head, magic, std::string{'n', 'i', version})) {
    refuse_contents("its data are in another file (.hdr and .img): write one .nii");
  }
  if (!has_text(head, magic, std::string{'n', '+', version, '\0'})) {
    refuse_contents(
        "it is an Analyze file, which does not say where in the world it is: convert "
        "it to NIfTI");
  }
  return Reader(head, *kind).read(file_bytes);
}

}  // namespace tet
