// HDF5 files that HDF5 lays out and somebody else fills: it makes their few small parts in
// memory, and the large columns go straight to their places, so that a full disk or a Ctrl-C
// ends in our own error and not inside HDF5.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>

#include <absl/status/status.h>
#include <hdf5.h>

#include "core/files/block_writer.h"

namespace tet {

/// An HDF5 identifier and the function that closes it.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close_function)(hid_t)) : id_(id), close_(close_function) {}
  ~Hdf5Handle() { close(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept;
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;

  hid_t get() const noexcept { return id_; }
  bool ok() const noexcept { return id_ >= 0; }
  bool close() noexcept;

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

using Hdf5Shape = std::initializer_list<hsize_t>;

/// Builds one group of a new file; after the first failure every call fails. No time stamps:
/// the same mesh is the same bytes.
class Hdf5Outline {
 public:
  Hdf5Outline(const std::string& path, const char* group);

  bool ok() const noexcept { return ok_ && group_.ok(); }
  /// False when anything failed, the last writes included.
  bool close() { return group_.close() && file_.close() && ok_; }

  void attribute(const char* name, hid_t type, Hdf5Shape shape, const void* value);
  void group(const char* name);
  void number(const char* name, std::uint64_t value);
  /// Reserves room for a column and says where; HADDR_UNDEF of a column without bytes.
  haddr_t column(const char* name, hid_t type, Hdf5Shape shape);

 private:
  Hdf5Handle create_dataset(const char* name, hid_t type, const Hdf5Handle& space);

  Hdf5Handle file_, group_;
  bool ok_ = true;
};

/// Makes `file` as long as it will be and writes all of it but the columns, which `lay_out`
/// reserves in the file at the path it is given, and which have `column_bytes` together. What
/// an outline adds to its columns is at most 64 KiB and another 1 KiB for each of `parts`.
absl::Status put_outline(AtomicFile& file,
                         BlockWriter& writer,
                         std::uint64_t column_bytes,
                         std::size_t parts,
                         const std::function<bool(const std::string& path)>& lay_out);

/// Where row `row` of a column lies; nothing of a column without bytes.
std::optional<std::uint64_t> place_of(haddr_t column, std::uint64_t row, std::size_t row_bytes);

/// Has `write` write from this place on, where there is one.
void write_at(BlockWriter& writer,
              std::optional<std::uint64_t> place,
              const std::function<void()>& write);

}  // namespace tet
