// What a file with an image holds, as its header tells: where its numbers are, and where in the
// world.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/volume/volume.h"

namespace tet {

enum class ImageFormat : std::uint8_t { kNifti, kNrrd, kMeta, kVti, kNumpy };

enum class ScalarType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
};

constexpr std::uint32_t bytes_of(ScalarType type) noexcept {
  constexpr std::array<std::uint32_t, 10> kBytes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}
constexpr bool is_integer(ScalarType type) noexcept { return type < ScalarType::kFloat32; }

/// As `info` has it: "int16".
const char* scalar_name(ScalarType type) noexcept;

enum class ImageEncoding : std::uint8_t {
  kRaw,
  kDeflate,    ///< one stream of zlib or gzip
  kText,       ///< numbers between white space
  kVtiBase64,  ///< VTK's blocks, each after its length, in base64
  kVtiRaw,     ///< such blocks, as they are
};

/// One array of numbers on one box of voxels.
struct ImageArray {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  bool big_endian = false;
  std::uint32_t components = 1;  ///< an image with more can only be told of
  /// Voxels along the axes of the array, the first of which runs fastest. Their product times
  /// the bytes of a value is at most kMostBytes.
  std::array<std::int32_t, 3> size{};
  VoxelTransform transform;  ///< of those axes; voxel (0, 0, 0) is the first one
  /// A stored number is worth slope * number + intercept.
  double slope = 1, intercept = 0;

  ImageEncoding encoding = ImageEncoding::kRaw;
  std::uint64_t offset = 0;  ///< of the data, in the file; in what it unpacks to where `packed`
  std::uint64_t bytes = 0;   ///< of the data in the file, or as far as it goes: up to its end
  bool blocks_deflated = false;    ///< VTK's blocks
  std::uint32_t length_bytes = 4;  ///< of VTK's lengths: 4 or 8

  std::uint64_t voxels() const noexcept {
    return std::uint64_t{1} * static_cast<std::uint64_t>(size[0]) *
           static_cast<std::uint64_t>(size[1]) * static_cast<std::uint64_t>(size[2]);
  }
  std::uint64_t value_bytes() const noexcept { return voxels() * bytes_of(type); }
};

inline constexpr std::uint64_t kMostImageBytes = std::uint64_t{1} << 40;

/// What coordinates of an image's world mean, where its file says so.
struct ImageSpace {
  std::string axes;  ///< "RAS", "LPS", ...: where x, y and z increase to; empty: not said
  std::string unit;  ///< "mm"; empty: not said
  std::string note;  ///< what was done about it, for people; may be empty
};

struct ImageOutline {
  ImageFormat format = ImageFormat::kNrrd;
  ImageSpace space;
  std::vector<ImageArray> arrays;  ///< at least one, but of a packed file
  /// The whole file is of gzip: only what unpacks it knows more than the length that its last
  /// bytes claim. That is modulo 2^32, and of the last member alone where there are several.
  bool packed = false;
  std::uint64_t unpacked_bytes = 0;
  /// The header goes on beyond what was looked at: there may be other arrays.
  bool cut = false;

  /// What reading it takes at most, bytes; of a packed file, what it takes at least that is as
  /// long as it claims.
  std::uint64_t volume_bytes() const noexcept;
  std::uint64_t reading_bytes(std::uint64_t file_bytes) const noexcept;

  /// What reading it may take: more than that of a packed file, which may be longer than it
  /// claims, and of few slices, whose bricks reach far beyond them.
  std::uint64_t most_volume_bytes(std::uint64_t file_bytes) const noexcept;
  std::uint64_t most_reading_bytes(std::uint64_t file_bytes) const noexcept;

  /// How much a packed file may have in it, unless that is much smaller than images are when
  /// packed; 0 of one that is not.
  std::uint64_t most_unpacked_bytes(std::uint64_t file_bytes) const noexcept;
};

const char* format_name(ImageFormat format) noexcept;  ///< "NIfTI"

}  // namespace tet
