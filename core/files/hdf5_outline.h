// HDF5 files that HDF5 lays out and somebody else fills: it makes their few small parts in
// memory, and the large columns go straight to their places, so that a full disk or a Ctrl-C
// ends in our own error and not inside HDF5.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/files/block_writer.h"

namespace tet {

/// Numbers of a file, little-endian; or a text of fixed length.
enum class Hdf5Type : std::uint8_t { kFloat64, kFloat32, kInt64, kInt32, kUint8, kText };

/// Says what one group of a new file has, in the order in which it is made. No time stamps: the
/// same mesh is the same bytes.
class Hdf5Outline {
 public:
  using Shape = std::vector<std::uint64_t>;
  /// Which column it is, in the order in which they were named.
  using Column = std::size_t;
  static constexpr Column kNoColumn = std::numeric_limits<Column>::max();

  enum class Kind : std::uint8_t { kAttribute, kGroup, kNumber, kColumn };
  struct Item {
    Kind kind = Kind::kGroup;
    std::string name;
    Hdf5Type type = Hdf5Type::kInt64;
    Shape shape = {};        ///< none: one value
    std::string bytes = {};  ///< of an attribute, and of a number
  };

  explicit Hdf5Outline(std::string group) : group_(std::move(group)) {}

  void attribute(std::string name, std::span<const std::int64_t> values);
  void attribute(std::string name, std::string_view text);
  void group(std::string name);
  void number(std::string name, std::uint64_t value);
  Column column(std::string name, Hdf5Type type, Shape shape);

  const std::string& name() const noexcept { return group_; }
  const std::vector<Item>& items() const noexcept { return items_; }

 private:
  std::string group_;
  std::vector<Item> items_;
  std::size_t columns_ = 0;
};

/// Where the columns of a file lie.
class Hdf5Places {
 public:
  /// Stands for the place of a column without bytes.
  static constexpr std::uint64_t kNowhere = std::numeric_limits<std::uint64_t>::max();

  Hdf5Places() = default;
  explicit Hdf5Places(std::vector<std::uint64_t> places) : places_(std::move(places)) {}

  /// Where row `row` lies; nothing of a column that is not there or has no bytes.
  std::optional<std::uint64_t> of(Hdf5Outline::Column column,
                                  std::uint64_t row,
                                  std::size_t row_bytes) const;

 private:
  std::vector<std::uint64_t> places_;
};

/// Makes `file` as long as it will be and writes all of it but the columns, which have
/// `column_bytes` together. What an outline adds to its columns is at most 64 KiB and another
/// 1 KiB for each of `parts`. Errors: those of AtomicFile, kResourceExhausted, kUnavailable
/// (HDF5 is not there).
absl::StatusOr<Hdf5Places> put_outline(AtomicFile& file,
                                       BlockWriter& writer,
                                       std::uint64_t column_bytes,
                                       std::size_t parts,
                                       const Hdf5Outline& outline);

/// Has `write` write from this place on, where there is one.
void write_at(BlockWriter& writer,
              std::optional<std::uint64_t> place,
              const std::function<void()>& write);

}  // namespace tet
