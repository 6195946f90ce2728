#include "core/files/write_vtkhdf.h"

#include <array>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>
#include <hdf5.h>

#include "core/base/check.h"
#include "core/base/posix/descriptor.h"
#include "core/base/posix/transfer.h"
#include "core/files/mesh_columns.h"

namespace tet {
namespace {

/// An HDF5 identifier and the function that closes it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close_function)(hid_t)) : id_(id), close_(close_function) {}
  ~Handle() { close(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;

  hid_t get() const noexcept { return id_; }
  bool ok() const noexcept { return id_ >= 0; }
  bool close() noexcept { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

using Shape = std::initializer_list<hsize_t>;

Handle make_space(Shape shape) {
  const auto rank = static_cast<int>(shape.size());
  return {rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, std::data(shape), nullptr),
          H5Sclose};
}

/// No time stamps: the same mesh is the same bytes.
Handle without_times(hid_t property_class) {
  Handle properties(H5Pcreate(property_class), H5Pclose);
  H5Pset_obj_track_times(properties.get(), 0);
  return properties;
}

/// Where HDF5 has put the columns; nothing for a column without bytes.
struct Layout {
  haddr_t points = HADDR_UNDEF, connectivity = HADDR_UNDEF, offsets = HADDR_UNDEF;
  haddr_t types = HADDR_UNDEF, regions = HADDR_UNDEF, parts = HADDR_UNDEF;
  std::vector<haddr_t> fields = {};
};

/// Builds the `VTKHDF` group of a file; after the first failure every call fails.
class Skeleton {
 public:
  explicit Skeleton(const std::string& path)
      : file_(create_file(path), H5Fclose),
        group_(H5Gcreate2(file_.get(), "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Gclose) {}

  bool ok() const noexcept { return ok_ && group_.ok(); }
  /// False when anything failed, the last writes included.
  bool close() { return group_.close() && file_.close() && ok_; }

  void attribute(const char* name, hid_t type, Shape shape, const void* value) {
    const Handle space = make_space(shape);
    const Handle attribute(
        H5Acreate2(group_.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    ok_ = ok_ && H5Awrite(attribute.get(), type, value) >= 0;
  }

  void group(const char* name) {
    const Handle made(H5Gcreate2(group_.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      H5Gclose);
    ok_ = ok_ && made.ok();
  }

  void number(const char* name, std::uint64_t value) {
    const Handle space = make_space({1});
    const Handle dataset = create_dataset(name, H5T_STD_I64LE, space);
    ok_ = ok_ && H5Dwrite(dataset.get(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                          &value) >= 0;
  }

  /// Reserves room for a column and says where.
  haddr_t column(const char* name, hid_t type, Shape shape) {
    const Handle space = make_space(shape);
    const Handle dataset = create_dataset(name, type, space);
    ok_ = ok_ && dataset.ok();
    return ok_ ? H5Dget_offset(dataset.get()) : HADDR_UNDEF;
  }

 private:
  static hid_t create_file(const std::string& path) {
    const Handle properties = without_times(H5P_FILE_CREATE);
    return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties.get(), H5P_DEFAULT);
  }

  Handle create_dataset(const char* name, hid_t type, const Handle& space) {
    const Handle properties = without_times(H5P_DATASET_CREATE);
    H5Pset_layout(properties.get(), H5D_CONTIGUOUS);
    H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
    H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER);
    return {H5Dcreate2(group_.get(), name, type, space.get(), H5P_DEFAULT, properties.get(),
                       H5P_DEFAULT),
            H5Dclose};
  }

  Handle file_, group_;
  bool ok_ = true;
};

/// VTK 9.1 wants the type as a string of fixed length.
void write_type_attribute(Skeleton& skeleton) {
  constexpr std::string_view kType = "UnstructuredGrid";
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), kType.size());
  skeleton.attribute("Type", type.get(), {}, kType.data());
}

/// Which number the part of each grid has, as arrays called like the grids.
void add_part_names(Skeleton& skeleton, const MeshHeader& mesh) {
  skeleton.group("FieldData");
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    const std::string name = absl::StrReplaceAll(mesh.parts[i].name, {{"/", "_"}});
    skeleton.number(absl::StrCat("FieldData/", name).c_str(), i + 1);
  }
}

std::optional<Layout> lay_out(const std::string& path,
                              const MeshHeader& mesh,
                              const ColumnTypes& types) {
  const hid_t real =
      types.coordinates == CoordinateType::kFloat64 ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
  const hid_t id = types.ids == IndexType::kUint64 ? H5T_STD_I64LE : H5T_STD_I32LE;
  const std::array<std::int64_t, 2> version{1, 0};

  Skeleton skeleton(path);
  skeleton.attribute("Version", H5T_STD_I64LE, {2}, version.data());
  write_type_attribute(skeleton);
  skeleton.number("NumberOfPoints", mesh.vertex_count);
  skeleton.number("NumberOfCells", mesh.tet_count);
  skeleton.number("NumberOfConnectivityIds", 4 * mesh.tet_count);
  Layout layout{.points = skeleton.column("Points", real, {mesh.vertex_count, 3}),
                .connectivity = skeleton.column("Connectivity", id, {4 * mesh.tet_count}),
                .offsets = skeleton.column("Offsets", id, {mesh.tet_count + 1}),
                .types = skeleton.column("Types", H5T_STD_U8LE, {mesh.tet_count})};
  if (mesh.has_regions) {
    skeleton.group("CellData");
    layout.regions = skeleton.column("CellData/region", H5T_STD_U8LE, {mesh.tet_count});
  }
  if (!mesh.parts.empty()) {
    skeleton.group("CellData");
    layout.parts = skeleton.column("CellData/part", H5T_STD_U8LE, {mesh.tet_count});
    add_part_names(skeleton, mesh);
  }
  if (!mesh.fields.empty()) skeleton.group("PointData");
  for (const FieldArray& field : mesh.fields) {
    const std::string name = absl::StrCat("PointData/", field.name);
    layout.fields.push_back(
        field.components == 1
            ? skeleton.column(name.c_str(), H5T_IEEE_F32LE, {mesh.vertex_count})
            : skeleton.column(name.c_str(), H5T_IEEE_F32LE,
                              {mesh.vertex_count, field.components}));
  }
  if (!skeleton.close()) return std::nullopt;
  return layout;
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

/// More than HDF5 adds to the columns.
constexpr std::uint64_t kSkeletonBytes = 64 * 1024;

/// HDF5 prints every failure to stderr unless told not to; ours are told once, by status.
void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// Where row `row` of a column lies; nothing of a column without bytes.
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

}  // namespace

struct VtkHdfWriter::Impl {
  ColumnTypes types;
  Layout layout;
  BlockWriter writer;
};

VtkHdfWriter::VtkHdfWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VtkHdfWriter::VtkHdfWriter(VtkHdfWriter&&) noexcept = default;
VtkHdfWriter::~VtkHdfWriter() = default;

absl::StatusOr<VtkHdfWriter> VtkHdfWriter::begin(AtomicFile& file,
                                                 const MeshHeader& mesh,
                                                 const WriteControl& control) {
  silence_hdf5();
  const ColumnTypes types = choose_column_types(mesh);
  const std::uint64_t tets = mesh.tet_count;
  const std::uint64_t column_bytes = column_sizes(mesh, types, tets + 1).total();
  // Limits on file sizes hold for files in memory too, and must not meet HDF5 either.
  absl::Status status = file.resize(column_bytes + kSkeletonBytes);
  if (!status.ok()) return status;

  const MemoryFile skeleton;
  const auto layout = skeleton.ok() ? lay_out(skeleton.path(), mesh, types) : std::nullopt;
  if (!layout) return absl::ResourceExhaustedError("HDF5 cannot lay out a file in memory");
  if (status = file.resize(skeleton.size()); !status.ok()) return status;

  auto impl =
      std::unique_ptr<Impl>(new Impl{types, *layout, BlockWriter(file, column_bytes, control)});
  BlockWriter& writer = impl->writer;
  skeleton.copy_to(writer);
  write_at(writer, place_of(layout->offsets, 0, 0),
           [&] { write_offsets(writer, 0, tets + 1, types.ids); });
  write_at(writer, place_of(layout->types, 0, 0), [&] { write_types(writer, tets); });
  write_at(writer, place_of(layout->parts, 0, 0), [&] { write_part_numbers(writer, mesh); });
  if (!writer.status().ok()) return writer.status();
  return VtkHdfWriter(std::move(impl));
}

absl::Status VtkHdfWriter::put(const TetMesh& part, const ChunkExtent& place) {
  const ColumnTypes& as = impl_->types;
  const Layout& layout = impl_->layout;
  BlockWriter& to = impl_->writer;
  write_at(to, place_of(layout.points, place.first_vertex, 3 * size_of(as.coordinates)),
           [&] { write_points(to, part, as.coordinates); });
  write_at(to, place_of(layout.connectivity, place.first_tet, 4 * size_of(as.ids)),
           [&] { write_connectivity(to, part, as.ids); });
  write_at(to, place_of(layout.regions, place.first_tet, 1),
           [&] { to.bytes(part.regions.bytes()); });
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const std::size_t row_bytes = part.header.fields[i].components * sizeof(float);
    write_at(to, place_of(layout.fields[i], place.first_vertex, row_bytes),
             [&] { write_field(to, part, i); });
  }
  return to.status();
}

absl::Status write_vtkhdf(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  auto writer = VtkHdfWriter::begin(file, mesh.header, control);
  if (!writer.ok()) return writer.status();
  return writer->put(mesh, {0, mesh.header.vertex_count, 0, mesh.header.tet_count});
}

}  // namespace tet
