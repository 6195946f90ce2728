#include "core/vdb/openvdb/vdb_file.h"

#include <utility>

#include <absl/strings/str_format.h>

#include "core/vdb/walk/grid_names.h"

namespace tet {
namespace {

namespace vdb = openvdb;

/// Older files do not tell node by node how it is compressed, and the walker does not know
/// them.
constexpr std::uint32_t kOldestFormat = vdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;

/// Bytes of the magic number, the versions and the flags that every file starts with.
constexpr std::int64_t kSmallestFile = 20;

}  // namespace

VdbFile::VdbFile(int descriptor, std::int64_t size)
    : buffer_(descriptor, size), stream_(&buffer_), size_(size) {
  vdb::initialize();
  open();
  read_entries();
}

void VdbFile::open() {
  stream_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  if (size_ < kSmallestFile) {
    OPENVDB_THROW(vdb::IoError, absl::StrFormat("it has only %d bytes", size_));
  }
  vdb::io::setStreamMetadataPtr(stream_, metadata_, /*transfer=*/false);
  readHeader(stream_);
  setFormatVersion(stream_);
  setLibraryVersion(stream_);
  setDataCompression(stream_);
  if (fileVersion() < kOldestFormat || fileVersion() > vdb::OPENVDB_FILE_VERSION) {
    OPENVDB_THROW(vdb::IoError,
                  absl::StrFormat("its format is %d, and only %d to %d can be read: write it "
                                  "again with OpenVDB %s",
                                  fileVersion(), kOldestFormat, vdb::OPENVDB_FILE_VERSION,
                                  OPENVDB_LIBRARY_VERSION_STRING));
  }
}

void VdbFile::read_entries() {
  vdb::MetaMap file_metadata;
  file_metadata.readMeta(stream_);
  const std::int32_t count = readGridCount(stream_);
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int64_t start = stream_.tellg();
    Entry entry;
    entry.grid = entry.descriptor.read(stream_);
    const bool random_access = inputHasGridOffsets();
    if (random_access) check_extent(entry, start);
    read_header(entry);
    if (!random_access && !entry.descriptor.isInstance()) {
      entry.grid->readTopology(stream_);
      entry.grid->readBuffers(stream_);
    }
    entry.complete = !random_access;
    if (random_access) entry.descriptor.seekToEnd(stream_);
    entries_.push_back(std::move(entry));
  }
  std::vector<std::string> stored;
  for (const Entry& entry : entries_) stored.push_back(entry.descriptor.uniqueName());
  names_ = shown_names(stored);
}

void VdbFile::check_extent(const Entry& entry, std::int64_t position) const {
  const std::int64_t start = entry.descriptor.getGridPos();
  const std::int64_t end = entry.descriptor.getEndPos();
  if (start < position || end < start) {
    OPENVDB_THROW(vdb::IoError, absl::StrFormat("a grid claims bytes %d to %d", start, end));
  }
  if (end > size_) {
    OPENVDB_THROW(vdb::IoError,
                  absl::StrFormat("it is truncated: a grid ends at byte %d and the file at %d",
                                  end, size_));
  }
}

void VdbFile::read_header(Entry& entry) {
  // What follows is read the way this grid was written; OpenVDB finds that beside the stream.
  metadata_->setHalfFloat(entry.descriptor.saveFloatAsHalf());
  vdb::io::setGridClass(stream_, vdb::GRID_UNKNOWN);
  vdb::io::setGridBackgroundValuePtr(stream_, nullptr);
  readGridCompression(stream_);
  entry.grid->readMeta(stream_);
  metadata_->gridMetadata() = static_cast<const vdb::MetaMap&>(*entry.grid);
  vdb::io::setGridClass(stream_, static_cast<std::uint32_t>(entry.grid->getGridClass()));
  entry.grid->readTransform(stream_);
}

VdbFile::Entry& VdbFile::tree_owner(Entry& entry) {
  if (!entry.descriptor.isInstance()) return entry;
  for (Entry& other : entries_) {
    const bool owner = other.descriptor.uniqueName() == entry.descriptor.instanceParentName();
    if (owner && !other.descriptor.isInstance()) return other;
  }
  OPENVDB_THROW(vdb::IoError, "a grid shares the tree of another that is not in the file");
}

void VdbFile::read_topology(std::size_t i) {
  Entry& entry = entries_[i];
  Entry& owner = tree_owner(entry);
  if (!owner.complete) {
    owner.descriptor.seekToGrid(stream_);
    read_header(owner);
    owner.grid->readTopology(stream_);
  }
  if (&owner != &entry) entry.grid->setTree(owner.grid->baseTreePtr());
}

void VdbFile::read_values(std::size_t i) {
  Entry& owner = tree_owner(entries_[i]);
  if (!owner.complete) owner.grid->readBuffers(stream_);
}

}  // namespace tet
