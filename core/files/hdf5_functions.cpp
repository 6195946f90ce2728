#include "core/files/hdf5_functions.h"

#include <utility>

#include <hdf5.h>

namespace tet {
namespace {

/// An HDF5 identifier and the function that closes it.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close_function)(hid_t)) : id_(id), close_(close_function) {}
  ~Hdf5Handle() { close(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;

  hid_t get() const noexcept { return id_; }
  bool ok() const noexcept { return id_ >= 0; }
  bool close() noexcept { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

Hdf5Handle make_space(const Hdf5Outline::Shape& shape) {
  const auto rank = static_cast<int>(shape.size());
  const std::vector<hsize_t> extent(shape.begin(), shape.end());
  return {rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, extent.data(), nullptr),
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

hid_t number_type(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::kFloat64:
      return H5T_IEEE_F64LE;
    case Hdf5Type::kFloat32:
      return H5T_IEEE_F32LE;
    case Hdf5Type::kInt32:
      return H5T_STD_I32LE;
    case Hdf5Type::kUint8:
      return H5T_STD_U8LE;
    default:
      return H5T_STD_I64LE;
  }
}

/// Builds one group of a new file; after the first failure every call fails.
class Hdf5Maker {
 public:
  Hdf5Maker(const std::string& path, const std::string& group)
      : file_(create_hdf5_file(path), H5Fclose),
        group_(H5Gcreate2(file_.get(), group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Gclose) {}

  /// False when anything failed, the last writes included.
  bool close() { return group_.close() && file_.close() && ok_; }

  void make(const Hdf5Outline::Item& item, std::vector<std::uint64_t>& places) {
    switch (item.kind) {
      case Hdf5Outline::Kind::kAttribute:
        return attribute(item);
      case Hdf5Outline::Kind::kGroup:
        return group(item);
      case Hdf5Outline::Kind::kNumber:
        return number(item);
      case Hdf5Outline::Kind::kColumn:
        places.push_back(column(item));
    }
  }

 private:
  void attribute(const Hdf5Outline::Item& item);
  void group(const Hdf5Outline::Item& item);
  void number(const Hdf5Outline::Item& item);
  std::uint64_t column(const Hdf5Outline::Item& item);
  Hdf5Handle create_dataset(const Hdf5Outline::Item& item);

  Hdf5Handle file_, group_;
  bool ok_ = true;
};

void Hdf5Maker::attribute(const Hdf5Outline::Item& item) {
  const Hdf5Handle space = make_space(item.shape);
  const bool text = item.type == Hdf5Type::kText;
  const Hdf5Handle type(H5Tcopy(text ? H5T_C_S1 : number_type(item.type)), H5Tclose);
  if (text) H5Tset_size(type.get(), item.bytes.size());
  const Hdf5Handle attribute(H5Acreate2(group_.get(), item.name.c_str(), type.get(),
                                        space.get(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  ok_ = ok_ && H5Awrite(attribute.get(), type.get(), item.bytes.data()) >= 0;
}

void Hdf5Maker::group(const Hdf5Outline::Item& item) {
  const Hdf5Handle made(
      H5Gcreate2(group_.get(), item.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Gclose);
  ok_ = ok_ && made.ok();
}

void Hdf5Maker::number(const Hdf5Outline::Item& item) {
  const Hdf5Handle dataset = create_dataset(item);
  ok_ = ok_ && H5Dwrite(dataset.get(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                        item.bytes.data()) >= 0;
}

std::uint64_t Hdf5Maker::column(const Hdf5Outline::Item& item) {
  const Hdf5Handle dataset = create_dataset(item);
  ok_ = ok_ && dataset.ok();
  const haddr_t place = ok_ ? H5Dget_offset(dataset.get()) : HADDR_UNDEF;
  return place == HADDR_UNDEF ? Hdf5Places::kNowhere : place;
}

Hdf5Handle Hdf5Maker::create_dataset(const Hdf5Outline::Item& item) {
  const Hdf5Handle space = make_space(item.shape);
  const Hdf5Handle properties = without_times(H5P_DATASET_CREATE);
  H5Pset_layout(properties.get(), H5D_CONTIGUOUS);
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER);
  return {H5Dcreate2(group_.get(), item.name.c_str(), number_type(item.type), space.get(),
                     H5P_DEFAULT, properties.get(), H5P_DEFAULT),
          H5Dclose};
}

bool lay_out(const std::string& path,
             const Hdf5Outline& outline,
             std::vector<std::uint64_t>& places) {
  // HDF5 prints every failure to stderr unless told not to; ours are told once, by status.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Hdf5Maker maker(path, outline.name());
  for (const Hdf5Outline::Item& item : outline.items()) maker.make(item, places);
  return maker.close();
}

}  // namespace

const Hdf5Part& hdf5_functions() {
  static constexpr Hdf5Part kPart{&lay_out};
  return kPart;
}

}  // namespace tet
