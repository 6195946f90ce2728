#include "core/files/hdf5_outline.h"

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <unistd.h>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/base/posix/descriptor.h"
#include "core/base/posix/transfer.h"
#include "core/files/hdf5_part.h"

namespace tet {
namespace {

/// A file in memory that HDF5 may fill without meeting a full disk, which it does not survive.
/// The columns it reserves are holes, and take no memory.
class MemoryFile {
 public:
  /// A name is needed, for HDF5 cannot open a nameless file (memfd) through /proc.
  MemoryFile() : path_((memory_directory() / "tetstream.XXXXXX").string()) {
    descriptor_ = Descriptor(mkostemp(path_.data(), O_CLOEXEC));
  }
  ~MemoryFile() {
    if (ok()) ::unlink(path_.c_str());
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  bool ok() const noexcept { return descriptor_.is_open(); }
  const std::string& path() const noexcept { return path_; }
  std::uint64_t size() const {
    return static_cast<std::uint64_t>(::lseek(descriptor_.number(), 0, SEEK_END));
  }

  /// Writes everything but the holes.
  void copy_to(BlockWriter& writer) const {
    std::vector<std::byte> segment;
    for (off_t end = 0;;) {
      const off_t begin = ::lseek(descriptor_.number(), end, SEEK_DATA);
      if (begin < 0) return;
      end = ::lseek(descriptor_.number(), begin, SEEK_HOLE);
      segment.resize(static_cast<std::size_t>(end - begin));
      const std::int64_t got =
          read_all_at(descriptor_.number(), static_cast<std::uint64_t>(begin), segment);
      TET_CHECK(got == end - begin);
      writer.move_to(static_cast<std::uint64_t>(begin));
      writer.bytes(segment);
    }
  }

 private:
  static std::filesystem::path memory_directory() {
    const std::filesystem::path shared_memory = "/dev/shm";
    return access(shared_memory.c_str(), W_OK) == 0 ? shared_memory
                                                    : std::filesystem::temp_directory_path();
  }

  std::string path_;
  Descriptor descriptor_;
};

}  // namespace

void Hdf5Outline::attribute(std::string name, std::span<const std::int64_t> values) {
  const auto bytes = std::as_bytes(values);
  items_.push_back({Kind::kAttribute,
                    std::move(name),
                    Hdf5Type::kInt64,
                    {values.size()},
                    {reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
}

void Hdf5Outline::attribute(std::string name, std::string_view text) {
  items_.push_back({Kind::kAttribute, std::move(name), Hdf5Type::kText, {}, std::string(text)});
}

void Hdf5Outline::group(std::string name) { items_.push_back({Kind::kGroup, std::move(name)}); }

void Hdf5Outline::number(std::string name, std::uint64_t value) {
  const auto* const bytes = reinterpret_cast<const char*>(&value);
  items_.push_back(
      {Kind::kNumber, std::move(name), Hdf5Type::kInt64, {1}, {bytes, sizeof(value)}});
}

Hdf5Outline::Column Hdf5Outline::column(std::string name, Hdf5Type type, Shape shape) {
  items_.push_back({Kind::kColumn, std::move(name), type, std::move(shape), {}});
  return columns_++;
}

std::optional<std::uint64_t> Hdf5Places::of(Hdf5Outline::Column column,
                                            std::uint64_t row,
                                            std::size_t row_bytes) const {
  if (column >= places_.size() || places_[column] == kNowhere) return std::nullopt;
  return places_[column] + row * row_bytes;
}

absl::StatusOr<Hdf5Places> put_outline(AtomicFile& file,
                                       BlockWriter& writer,
                                       std::uint64_t column_bytes,
                                       std::size_t parts,
                                       const Hdf5Outline& outline) {
  constexpr std::uint64_t kOutlineBytes = 64 * 1024, kPartBytes = 1024;
  const absl::StatusOr<const Hdf5Part*> hdf5 = hdf5_part();
  if (!hdf5.ok()) return hdf5.status();
  // Limits on file sizes hold for files in memory too, and must not meet HDF5 either.
  absl::Status status = file.resize(column_bytes + kOutlineBytes + parts * kPartBytes);
  if (!status.ok()) return status;
  const MemoryFile laid_out;
  std::vector<std::uint64_t> places;
  if (!laid_out.ok() || !(*hdf5)->lay_out(laid_out.path(), outline, places)) {
    return absl::ResourceExhaustedError("HDF5 cannot lay out a file in memory");
  }
  if (status = file.resize(laid_out.size()); !status.ok()) return status;
  laid_out.copy_to(writer);
  if (!writer.status().ok()) return writer.status();
  return Hdf5Places(std::move(places));
}

void write_at(BlockWriter& writer,
              std::optional<std::uint64_t> place,
              const std::function<void()>& write) {
  if (!place) return;
  writer.move_to(*place);
  write();
}

}  // namespace tet
