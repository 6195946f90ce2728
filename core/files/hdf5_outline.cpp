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

namespace tet {
namespace {

Hdf5Handle make_space(Hdf5Shape shape) {
  const auto rank = static_cast<int>(shape.size());
  return {rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, std::data(shape), nullptr),
          H5Sclose};
}

Hdf5Handle without_times(hid_t property_class) {
  Hdf5Handle properties(H5Pcreate(property_class), H5Pclose);
  H5Pset_obj_track_times(properties.get(), 0);
  return properties;
}

hid_t create_hdf5_file(const std::string& path) {
  const Hdf5Handle properties = without_times(H5P_FILE_CREATE);
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties.get(), H5P_DEFAULT);
}

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

/// HDF5 prints every failure to stderr unless told not to; ours are told once, by status.
void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

}  // namespace

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept
    : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

bool Hdf5Handle::close() noexcept { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

Hdf5Outline::Hdf5Outline(const std::string& path, const char* group)
    : file_(create_hdf5_file(path), H5Fclose),
      group_(H5Gcreate2(file_.get(), group, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose) {}

void Hdf5Outline::attribute(const char* name, hid_t type, Hdf5Shape shape, const void* value) {
  const Hdf5Handle space = make_space(shape);
  const Hdf5Handle attribute(
      H5Acreate2(group_.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  ok_ = ok_ && H5Awrite(attribute.get(), type, value) >= 0;
}

void Hdf5Outline::group(const char* name) {
  const Hdf5Handle made(H5Gcreate2(group_.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                        H5Gclose);
  ok_ = ok_ && made.ok();
}

void Hdf5Outline::number(const char* name, std::uint64_t value) {
  const Hdf5Handle space = make_space({1});
  const Hdf5Handle dataset = create_dataset(name, H5T_STD_I64LE, space);
  ok_ = ok_ &&
        H5Dwrite(dataset.get(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) >= 0;
}

haddr_t Hdf5Outline::column(const char* name, hid_t type, Hdf5Shape shape) {
  const Hdf5Handle space = make_space(shape);
  const Hdf5Handle dataset = create_dataset(name, type, space);
  ok_ = ok_ && dataset.ok();
  return ok_ ? H5Dget_offset(dataset.get()) : HADDR_UNDEF;
}

Hdf5Handle Hdf5Outline::create_dataset(const char* name, hid_t type, const Hdf5Handle& space) {
  const Hdf5Handle properties = without_times(H5P_DATASET_CREATE);
  H5Pset_layout(properties.get(), H5D_CONTIGUOUS);
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER);
  return {H5Dcreate2(group_.get(), name, type, space.get(), H5P_DEFAULT, properties.get(),
                     H5P_DEFAULT),
          H5Dclose};
}

absl::Status put_outline(AtomicFile& file,
                         BlockWriter& writer,
                         std::uint64_t column_bytes,
                         std::size_t parts,
                         const std::function<bool(const std::string& path)>& lay_out) {
  constexpr std::uint64_t kOutlineBytes = 64 * 1024, kPartBytes = 1024;
  silence_hdf5();
  // Limits on file sizes hold for files in memory too, and must not meet HDF5 either.
  absl::Status status = file.resize(column_bytes + kOutlineBytes + parts * kPartBytes);
  if (!status.ok()) return status;
  const MemoryFile outline;
  if (!outline.ok() || !lay_out(outline.path())) {
    return absl::ResourceExhaustedError("HDF5 cannot lay out a file in memory");
  }
  if (status = file.resize(outline.size()); !status.ok()) return status;
  outline.copy_to(writer);
  return writer.status();
}

std::optional<std::uint64_t> place_of(haddr_t column,
                                      std::uint64_t row,
                                      std::size_t row_bytes) {
  if (column == HADDR_UNDEF) return std::nullopt;
  return column + row * row_bytes;
}

void write_at(BlockWriter& writer,
              std::optional<std::uint64_t> place,
              const std::function<void()>& write) {
  if (!place) return;
  writer.move_to(*place);
  write();
}

}  // namespace tet
