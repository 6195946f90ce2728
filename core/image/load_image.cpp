#include "core/image/load_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include "core/image/describe_image.h"
#include "core/image/image_refusal.h"
#include "core/image/image_values.h"
#include "core/image/outline_image.h"
#include "core/volume/check_transform.h"
#include "core/volume/inside.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

/// Calls `read()`; a refusal becomes a status.
template <class Read>
auto guarded_reading(const Read& read) -> absl::StatusOr<decltype(read())> {
  try {
    return read();
  } catch (const ImageRefusal& refusal) {
    return refusal.status();
  }
}

std::string why_not(const ImageArray& array) {
  if (array.components == 1) return "";
  return absl::StrFormat("its voxels have %d values each: write one number a voxel",
                         array.components);
}

std::string names_of(const ImageOutline& outline) {
  return absl::StrJoin(outline.arrays, ", ", [](std::string* out, const ImageArray& array) {
    absl::StrAppend(out, "'", array.name, "'");
  });
}

const ImageArray& array_named(const ImageOutline& outline, const std::string& name) {
  const auto found = std::ranges::find(outline.arrays, name, &ImageArray::name);
  if (found != outline.arrays.end()) return *found;
  throw ImageRefusal(absl::NotFoundError(
      absl::StrFormat("there is no array '%s'; it has %s", name, names_of(outline))));
}

/// The only one that will do.
const ImageArray& only_array(const ImageOutline& outline) {
  const ImageArray* only = nullptr;
  for (const ImageArray& array : outline.arrays) {
    if (!why_not(array).empty()) continue;
    if (only != nullptr) {
      refuse_contents(
          absl::StrCat("it has several arrays; name one of them: ", names_of(outline)));
    }
    only = &array;
  }
  return only == nullptr ? outline.arrays.front() : *only;
}

const ImageArray& find_array(const ImageOutline& outline, const std::string& name) {
  const ImageArray& array = name.empty() ? only_array(outline) : array_named(outline, name);
  const std::string refusal = why_not(array);
  if (!refusal.empty()) refuse_contents(refusal);
  return array;
}

/// Numbers of an image as what they are worth.
template <class T>
struct Worth {
  std::span<const T> stored;
  double slope, intercept;

  float operator[](std::size_t i) const {
    const double value = static_cast<double>(stored[i]);
    if (slope == 1 && intercept == 0) return static_cast<float>(stored[i]);
    return static_cast<float>(slope * value + intercept);
  }
};

/// Voxels of a brick, and where those of the image are in it.
class BrickGather {
 public:
  explicit BrickGather(const std::array<std::int32_t, 3>& size) : size_(size) {}

  /// Calls `give(cell, index)` for all voxels of the brick that the image has. False where it
  /// has not all of them.
  template <class Give>
  bool each(BrickCoord b, const Give& give) const {
    const std::int32_t nx = std::min(8, size_[0] - 8 * b.x),
                       ny = std::min(8, size_[1] - 8 * b.y),
                       nz = std::min(8, size_[2] - 8 * b.z);
    for (std::int32_t z = 0; z < nz; ++z) {
      for (std::int32_t y = 0; y < ny; ++y) {
        const std::size_t row =
            (static_cast<std::size_t>(8 * b.z + z) * static_cast<std::size_t>(size_[1]) +
             static_cast<std::size_t>(8 * b.y + y)) *
                static_cast<std::size_t>(size_[0]) +
            static_cast<std::size_t>(8 * b.x);
        for (std::int32_t x = 0; x < nx; ++x) {
          give(static_cast<std::size_t>((x * 8 + y) * 8 + z),
               row + static_cast<std::size_t>(x));
        }
      }
    }
    return nx == 8 && ny == 8 && nz == 8;
  }

  template <class Visit>
  void for_each_brick(const Visit& visit) const {
    for (std::int32_t x = 0; 8 * x < size_[0]; ++x) {
      for (std::int32_t y = 0; 8 * y < size_[1]; ++y) {
        for (std::int32_t z = 0; 8 * z < size_[2]; ++z) visit(BrickCoord{x, y, z});
      }
    }
  }

 private:
  std::array<std::int32_t, 3> size_;
};

std::string place_of(const ImageArray& array, std::size_t i) {
  const auto nx = static_cast<std::size_t>(array.size[0]),
             ny = static_cast<std::size_t>(array.size[1]);
  return absl::StrFormat("(%d, %d, %d)", i % nx, i / nx % ny, i / nx / ny);
}

/// The least and the greatest value. Refuses what is no number.
template <class T>
ValueRange checked_range(const Worth<T>& values, const ImageArray& array) {
  ValueRange range{values[0], values[0]};
  std::size_t bad = 0, first_bad = 0;
  for (std::size_t i = 0; i < values.stored.size(); ++i) {
    const float value = values[i];
    if (!std::isfinite(value) && bad++ == 0) first_bad = i;
    range.min = std::min(range.min, value);
    range.max = std::max(range.max, value);
  }
  if (bad > 0) {
    refuse_contents(
        absl::StrFormat("%d of its %d values are no finite floats, the first of them at voxel "
                        "%s: give them the "
                        "value of what surrounds them (numpy.nan_to_num)",
                        bad, array.voxels(), place_of(array, first_bad)));
  }
  return range;
}

/// The mean of the values in the image's faces.
template <class T>
double mean_of_faces(const Worth<T>& values, const ImageArray& array) {
  const auto [nx, ny, nz] = array.size;
  double sum = 0, count = 0;
  std::size_t at = 0;
  for (std::int32_t z = 0; z < nz; ++z) {
    for (std::int32_t y = 0; y < ny; ++y) {
      const bool face = z == 0 || z == nz - 1 || y == 0 || y == ny - 1;
      const std::int32_t step = face || nx == 1 ? 1 : nx - 1;
      for (std::int32_t x = 0; x < nx; x += step) {
        sum += values[at + static_cast<std::size_t>(x)];
        ++count;
      }
      at += static_cast<std::size_t>(nx);
    }
  }
  return sum / count;
}

template <class T>
float background_of(const Worth<T>& values, const ImageArray& array, const ValueRange& range) {
  if (range.min >= 0 || range.max <= 0) return range.min;
  const double middle = (static_cast<double>(range.min) + range.max) / 2;
  return mean_of_faces(values, array) > middle ? range.max : range.min;
}

/// Fills in a volume's bricks: counted first, so that its columns have their sizes at once.
template <class T>
Volume bricks_of(Volume volume, const Worth<T>& values, const ImageArray& array) {
  const BrickGather gather(array.size);
  std::array<float, kBrickCells> brick;
  std::vector<ConstantBrick> constants;
  const auto fill = [&](BrickCoord at) {
    brick.fill(volume.background);
    gather.each(at, [&](std::size_t cell, std::size_t i) { brick[cell] = values[i] + 0.0F; });
    return std::ranges::all_of(brick, [&](float value) { return value == brick[0]; });
  };
  gather.for_each_brick([&](BrickCoord at) {
    if (!fill(at)) {
      volume.bricks.push_back(at);
    } else if (brick[0] != volume.background) {
      constants.push_back({at, brick[0]});
    }
  });
  volume.values.resize(volume.bricks.size() * kBrickCells);
  for (std::size_t i = 0; i < volume.bricks.size(); ++i) {
    fill(volume.bricks[i]);
    std::ranges::copy(brick,
                      volume.values.begin() + static_cast<std::ptrdiff_t>(i * kBrickCells));
  }
  absl::StatusOr<Volume> indexed = index_volume(std::move(volume), std::move(constants));
  if (!indexed.ok()) throw ImageRefusal(indexed.status());
  return *std::move(indexed);
}

template <class T>
Volume volume_from(const Worth<T>& values, const ImageArray& array, ImageUse use) {
  const ValueRange range = checked_range(values, array);
  if (use == ImageUse::kSurface && range.min == range.max) {
    refuse_contents(
        absl::StrFormat("all its %d voxels have the value %g", array.voxels(), range.min));
  }
  Volume volume;
  volume.name = array.name;
  volume.transform = array.transform;
  volume.background = background_of(values, array, range) + 0.0F;
  volume.kind = VolumeKind::kField;
  if (use == ImageUse::kSurface) {
    const KindOfValues kind = kind_of_values(range, volume.background);
    volume.kind = kind.kind;
    volume.kind_source = kind.source;
  }
  return bricks_of(std::move(volume), values, array);
}

/// A number as a label. Refuses what is no whole number.
template <class T>
std::int64_t label_of(const Worth<T>& values, const ImageArray& array, std::size_t i) {
  const bool scaled = values.slope != 1 || values.intercept != 0;
  const T stored = values.stored[i];
  if constexpr (std::is_integral_v<T>) {
    if (!scaled && std::in_range<std::int64_t>(stored))
      return static_cast<std::int64_t>(stored);
  }
  const double value = values.slope * static_cast<double>(stored) + values.intercept;
  constexpr double kMost = 9007199254740992.0;  // 2^53: beyond it doubles skip integers
  if (std::abs(value) <= kMost && value == std::floor(value)) {
    return static_cast<std::int64_t>(value);
  }
  refuse_contents(
      absl::StrFormat("voxel %s has the value %g, and labels are whole numbers: mesh it at an "
                      "iso value (--iso)",
                      place_of(array, i), value));
}

template <class T>
LabelVolume labels_from(const Worth<T>& values, const ImageArray& array) {
  const auto [nx, ny, nz] = array.size;
  LabelVolumeBuilder builder(array.name, array.transform,
                             {{0, 0, 0}, {nx - 1, ny - 1, nz - 1}});
  const BrickGather gather(array.size);
  std::array<std::int64_t, kBrickCells> brick{};
  gather.for_each_brick([&](BrickCoord at) {
    gather.each(
        at, [&](std::size_t cell, std::size_t i) { brick[cell] = label_of(values, array, i); });
    const absl::Status status = builder.add_brick(at, brick);
    if (!status.ok()) throw ImageRefusal(status);
  });
  return std::move(builder).build();
}

GridInfo describe_array(const ImageOutline& outline, const ImageArray& array) {
  GridInfo info;
  info.name = array.name;
  info.value_type = scalar_name(array.type);
  info.grid_class = "image";
  info.voxel_size = array.transform.voxel_size;
  info.active_voxels = array.voxels();
  info.active_box = {{0, 0, 0}, {array.size[0] - 1, array.size[1] - 1, array.size[2] - 1}};
  info.not_meshable = why_not(array);
  info.field_components = array.components == 1 ? 1 : 0;
  info.place = describe_image(outline, array);
  return info;
}

}  // namespace

absl::StatusOr<std::vector<GridInfo>> list_image(const ByteSource& source) {
  return guarded_reading([&] {
    const ImageOutline outline = full_outline(source, kNoLimit);
    std::vector<GridInfo> infos;
    for (const ImageArray& array : outline.arrays) {
      infos.push_back(describe_array(outline, array));
    }
    return infos;
  });
}

absl::StatusOr<Volume> load_image(const ByteSource& source,
                                  const std::string& name,
                                  ImageUse use,
                                  std::uint64_t most_reading_bytes) {
  return guarded_reading([&] {
    const ImageOutline outline = full_outline(source, most_reading_bytes);
    const ImageArray& array = find_array(outline, name);
    const std::vector<std::byte> bytes = read_values(source, outline, array);
    return visit_values(array.type, bytes, [&](auto stored) {
      using T = std::remove_const_t<typename decltype(stored)::element_type>;
      return volume_from(Worth<T>{stored, array.slope, array.intercept}, array, use);
    });
  });
}

absl::StatusOr<LabelVolume> load_labels(const ByteSource& source,
                                        const std::string& name,
                                        std::uint64_t most_reading_bytes) {
  return guarded_reading([&] {
    const ImageOutline outline = full_outline(source, most_reading_bytes);
    const ImageArray& array = find_array(outline, name);
    const std::vector<std::byte> bytes = read_values(source, outline, array);
    return visit_values(array.type, bytes, [&](auto stored) {
      using T = std::remove_const_t<typename decltype(stored)::element_type>;
      return labels_from(Worth<T>{stored, array.slope, array.intercept}, array);
    });
  });
}

}  // namespace tet
