#include "core/files/read_vtu.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <span>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

#include "core/base/parallel.h"
#include "core/base/posix/file.h"
#include "core/files/vtu_header.h"

namespace tet {
namespace {

constexpr double kLargestExact = 9007199254740992.0;

absl::Status wrong(const std::string& path, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", why));
}

template <class Number>
double value_at(const char* bytes) noexcept {
  Number number;
  std::memcpy(&number, bytes, sizeof(number));
  return static_cast<double>(number);
}

using ReadNumber = double (*)(const char* bytes) noexcept;

ReadNumber number_reader(NumberType type) noexcept {
  switch (type) {
    case NumberType::kInt8:
      return value_at<std::int8_t>;
    case NumberType::kUint8:
      return value_at<std::uint8_t>;
    case NumberType::kInt16:
      return value_at<std::int16_t>;
    case NumberType::kUint16:
      return value_at<std::uint16_t>;
    case NumberType::kInt32:
      return value_at<std::int32_t>;
    case NumberType::kUint32:
      return value_at<std::uint32_t>;
    case NumberType::kInt64:
      return value_at<std::int64_t>;
    case NumberType::kUint64:
      return value_at<std::uint64_t>;
    case NumberType::kFloat32:
      return value_at<float>;
    case NumberType::kFloat64:
      return value_at<double>;
  }
  return value_at<double>;
}

/// Reads one file, column by column.
class VtuReader {
 public:
  VtuReader(std::string path, File file, std::uint64_t size)
      : path_(std::move(path)), file_(std::move(file)), size_(size) {}

  absl::StatusOr<DataMesh> read() {
    absl::Status status = read_header();
    if (status.ok()) status = check_counts();
    if (status.ok()) status = check_cells();
    DataMesh mesh;
    if (status.ok()) status = read_points(mesh);
    if (status.ok()) status = read_tets(mesh);
    if (status.ok()) status = check_arrays();
    if (status.ok()) status = read_arrays(header_.point_data, header_.points, mesh.point_data);
    if (status.ok()) status = read_arrays(header_.cell_data, header_.cells, mesh.cell_data);
    if (!status.ok()) return status;
    mesh.of_whole = std::move(header_.of_whole);
    return mesh;
  }

 private:
  absl::Status read_header() {
    std::string beginning(std::min<std::uint64_t>(size_, kMaxVtuHeaderBytes), '\0');
    const auto got = file_.read_at(0, std::span(beginning));
    if (!got.ok()) return got.status();
    beginning.resize(*got);
    absl::StatusOr<VtuHeader> header = parse_vtu_header(beginning);
    if (!header.ok()) return wrong(path_, std::string(header.status().message()));
    header_ = *std::move(header);
    return absl::OkStatus();
  }

  absl::Status check_counts() const {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    for (const auto& [what, count] :
         {std::pair("points", header_.points), std::pair("cells", header_.cells)}) {
      if (count <= kMost) continue;
      return absl::ResourceExhaustedError(
          absl::StrCat(path_, ": it has ", count, " ", what, "; the limit is ", kMost));
    }
    return absl::OkStatus();
  }

  /// Arrays that lie upon each other would take memory that the file's size does not bound.
  absl::Status check_arrays() const {
    std::uint64_t bytes = 0;
    for (const auto& [columns, rows] : {std::pair(&header_.point_data, header_.points),
                                        std::pair(&header_.cell_data, header_.cells)}) {
      for (const VtuColumn& column : *columns) {
        bytes += rows * column.components * size_of(column.type);
      }
    }
    const std::uint64_t room = size_ - header_.data_start;
    if (bytes <= room) return absl::OkStatus();
    return wrong(path_,
                 absl::StrCat("its arrays have ", bytes, " bytes, and it has ", room,
                              " behind its XML: it was cut, or they lie upon each other"));
  }

  /// The bytes of a column, which must have so many rows.
  absl::StatusOr<std::vector<char>> read_column(const VtuColumn& column, std::uint64_t rows) {
    const std::uint64_t wanted = rows * column.components * size_of(column.type);
    const std::string name = absl::StrCat("its array \"", absl::CHexEscape(column.name), "\"");
    const std::uint64_t room = size_ - header_.data_start;
    if (column.offset > room || room - column.offset < header_.size_bytes) {
      return wrong(path_, absl::StrCat(name, " begins behind the file's end"));
    }
    std::uint64_t told = 0;
    const std::uint64_t at = header_.data_start + column.offset;
    if (auto status = read_exactly(at, {reinterpret_cast<char*>(&told), header_.size_bytes});
        !status.ok()) {
      return status;
    }
    if (told != wanted) {
      return wrong(path_, absl::StrCat(name, " has ", told, " bytes; ", rows, " rows of ",
                                       column.components, " ", vtu_name_of(column.type),
                                       " have ", wanted));
    }
    if (room - column.offset - header_.size_bytes < wanted) {
      return wrong(path_, absl::StrCat(name, " ends behind the file's end"));
    }
    std::vector<char> bytes(wanted);
    if (auto status = read_exactly(at + header_.size_bytes, bytes); !status.ok()) return status;
    return bytes;
  }

  absl::Status read_exactly(std::uint64_t at, std::span<char> bytes) {
    const auto got = file_.read_at(at, bytes);
    if (!got.ok()) return got.status();
    if (*got == bytes.size()) return absl::OkStatus();
    return wrong(path_, "it became shorter while it was read");
  }

  /// Numbers within [least, most].
  absl::StatusOr<std::vector<double>> read_numbers(const VtuColumn& column,
                                                   std::uint64_t rows,
                                                   double least,
                                                   double most) {
    const absl::StatusOr<std::vector<char>> bytes = read_column(column, rows);
    if (!bytes.ok()) return bytes.status();
    const ReadNumber number = number_reader(column.type);
    const std::size_t size = size_of(column.type);
    std::vector<double> values(bytes->size() / size);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = number(bytes->data() + i * size);
      if (values[i] >= least && values[i] <= most) continue;
      return wrong(path_, absl::StrCat("its array \"", absl::CHexEscape(column.name), "\" has ",
                                       values[i], " in row ", i / column.components,
                                       "; it must lie between ", least, " and ", most));
    }
    return values;
  }

  absl::Status check_shape(const VtuColumn& column, std::uint32_t components, bool integer) {
    if (column.components == components && is_integer(column.type) == integer) {
      return absl::OkStatus();
    }
    return wrong(path_,
                 absl::StrCat("its array \"", absl::CHexEscape(column.name),
                              "\" has another type or number of components than it must"));
  }

  absl::Status read_points(DataMesh& mesh) {
    if (auto status = check_shape(*header_.places, 3, false); !status.ok()) return status;
    const auto numbers = read_numbers(*header_.places, header_.points,
                                      -DataMesh::kMaxCoordinate, DataMesh::kMaxCoordinate);
    if (!numbers.ok()) return numbers.status();
    mesh.points.resize(header_.points);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      mesh.points[i] = {(*numbers)[3 * i], (*numbers)[3 * i + 1], (*numbers)[3 * i + 2]};
    }
    return absl::OkStatus();
  }

  /// All are tets, one behind the other.
  absl::Status check_cells() {
    if (auto status = check_shape(*header_.types, 1, true); !status.ok()) return status;
    if (auto status = check_shape(*header_.offsets, 1, true); !status.ok()) return status;
    const auto types = read_numbers(*header_.types, header_.cells, 0, 255);
    if (!types.ok()) return types.status();
    const auto offsets = read_numbers(*header_.offsets, header_.cells, 0, kLargestExact);
    if (!offsets.ok()) return offsets.status();
    for (std::size_t i = 0; i < types->size(); ++i) {
      if ((*types)[i] == kVtuTetra && (*offsets)[i] == 4.0 * static_cast<double>(i + 1))
        continue;
      return wrong(
          path_, absl::StrCat("its cell ", i, " is of type ", (*types)[i], " and ends at ",
                              (*offsets)[i], "; only tets of four corners are read, type 10"));
    }
    return absl::OkStatus();
  }

  absl::Status read_tets(DataMesh& mesh) {
    if (auto status = check_shape(*header_.connectivity, 1, true); !status.ok()) return status;
    const auto ids = read_numbers(*header_.connectivity, 4 * header_.cells, 0,
                                  static_cast<double>(header_.points) - 1);
    if (!ids.ok()) return ids.status();
    mesh.tets.resize(header_.cells);
    for (std::size_t i = 0; i < ids->size(); ++i) {
      mesh.tets[i / 4][i % 4] = static_cast<std::uint32_t>((*ids)[i]);
    }
    return absl::OkStatus();
  }

  absl::Status read_arrays(const std::vector<VtuColumn>& columns,
                           std::uint64_t rows,
                           std::vector<DataArray>& arrays) {
    for (const VtuColumn& column : columns) {
      // Beyond these an integer is no double, and squares are no numbers.
      const double most = is_integer(column.type) ? kLargestExact : 1e150;
      absl::StatusOr<std::vector<double>> values = read_numbers(column, rows, -most, most);
      if (!values.ok()) return values.status();
      arrays.push_back({column.name, column.components, column.type, *std::move(values)});
    }
    return absl::OkStatus();
  }

  std::string path_;
  File file_;
  std::uint64_t size_;
  VtuHeader header_;
};

}  // namespace

absl::StatusOr<DataMesh> read_vtu(const std::string& path) {
  absl::StatusOr<File> file = File::open(path, O_RDONLY, io_error);
  if (!file.ok()) return file.status();
  const absl::StatusOr<std::uint64_t> size = file->size();
  if (!size.ok()) return size.status();
  return VtuReader(path, *std::move(file), *size).read();
}

}  // namespace tet
