// Reading a .vdb file grid by grid, so that a file that ends early is always noticed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include "core/vdb/openvdb/descriptor_buffer.h"
#include "core/vdb/openvdb/vdb_grids.h"

namespace tet {

/// An open .vdb file: the names, metadata and transforms of its grids, and their trees on
/// demand.
///
/// OpenVDB's own reader ignores short reads and so accepts some truncated files; here each one
/// is an exception. Every member may throw openvdb::Exception, std::ios_base::failure (the file
/// ends early) or std::bad_alloc. Delayed loading never happens. Not thread-safe.
class VdbFile : private openvdb::io::Archive {
 public:
  /// Reads `size` bytes of an open file, which stays open as long as this.
  VdbFile(int descriptor, std::int64_t size);

  std::size_t grid_count() const noexcept { return entries_.size(); }

  /// The grid's name, by shown_names.
  const std::string& grid_name(std::size_t i) const { return names_[i]; }

  /// The grid; its tree is empty before `read_topology` and without values before
  /// `read_values`.
  const openvdb::GridBase& grid(std::size_t i) const { return *entries_[i].grid; }

  /// Reads the shape of the tree: nodes, tiles and masks. Leaves get no memory for values yet.
  void read_topology(std::size_t i);

  /// Reads the values of the leaves. `read_topology(i)` must have been the call before.
  void read_values(std::size_t i);

 private:
  struct Entry {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid;
    bool complete = false;  // read whole, because the file cannot be read out of order
  };

  void open();
  void read_entries();
  void check_extent(const Entry& entry, std::int64_t position) const;
  void read_header(Entry& entry);
  Entry& tree_owner(Entry& entry);

  // OpenVDB keeps the address of this pointer in the stream, to tell how its data is stored.
  openvdb::SharedPtr<openvdb::io::StreamMetadata> metadata_{new openvdb::io::StreamMetadata};
  DescriptorBuffer buffer_;
  std::istream stream_;
  std::int64_t size_ = 0;
  std::vector<Entry> entries_;
  std::vector<std::string> names_;
};

}  // namespace tet
