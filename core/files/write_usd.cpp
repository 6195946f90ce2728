#include "core/files/write_usd.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/files/face_groups.h"
#include "core/files/number_limits.h"
#include "core/files/tet_groups.h"
#include "core/files/text_numbers.h"

namespace tet {
namespace {

/// What one of each kind takes, more or less: for progress.
constexpr std::uint64_t kUsdPointBytes = 36, kUsdTetBytes = 34, kUsdFaceBytes = 28;
constexpr std::uint64_t kUsdIndexBytes = 8, kUsdValueBytes = 12;

class UsdWriter {
 public:
  UsdWriter(AtomicFile& file, const TetMesh& mesh, const WriteControl& control)
      : mesh_(mesh),
        header_(mesh.header),
        tets_(tet_groups(mesh)),
        faces_(mesh, control.stop()),
        writer_(
            file,
            header_.vertex_count * (kUsdPointBytes + kUsdValueBytes * header_.field_values()) +
                header_.tet_count * (kUsdTetBytes + kUsdIndexBytes) +
                faces_.count() * (kUsdFaceBytes + kUsdIndexBytes),
            control) {}

  absl::Status write() {
    writer_.text(
        "#usda 1.0\n(\n    defaultPrim = \"mesh\"\n    metersPerUnit = 1\n"
        "    upAxis = \"Z\"\n)\n\ndef TetMesh \"mesh\"\n{\n");
    write_place();
    write_usd_points();
    write_tets();
    write_faces();
    for (std::size_t i = 0; i < header_.fields.size(); ++i) write_primvar(i);
    write_subsets();
    writer_.text("}\n");
    return writer_.status();
  }

 private:
  /// Writes where the origin is, for positions are stored relative to it, and stay so.
  void write_place() {
    const auto& [x, y, z] = header_.origin;
    std::array<char, 256> text{};
    char* end = put_text(text.data(), "    double3 xformOp:translate = (");
    end = put_text(put_coordinate(end, x, CoordinateType::kFloat64), ", ");
    end = put_text(put_coordinate(end, y, CoordinateType::kFloat64), ", ");
    end = put_text(put_coordinate(end, z, CoordinateType::kFloat64), ")\n");
    writer_.text({text.data(), static_cast<std::size_t>(end - text.data())});
    writer_.text("    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n");
    const WorldPoint &min = header_.bounds.min, &max = header_.bounds.max;
    end = put_text(text.data(), "    float3[] extent = [");
    end = put_tuple(end, std::array{min.x - x, min.y - y, min.z - z}, put_float);
    end =
        put_tuple(put_text(end, ", "), std::array{max.x - x, max.y - y, max.z - z}, put_float);
    end = put_text(end, "]\n");
    writer_.text({text.data(), static_cast<std::size_t>(end - text.data())});
  }

  /// Writes `count` things with a comma after each but the last.
  template <class Put>
  void list(const std::string& name,
            std::uint64_t count,
            std::uint64_t nominal_bytes,
            const Put& put) {
    writer_.text(absl::StrCat(name, " = ["));
    writer_.lines(count, nominal_bytes, [&](std::uint64_t i, char* place) {
      return put_text(put(i, place), i + 1 == count ? "" : i % 8 == 7 ? ",\n" : ", ");
    });
    writer_.text("]");
  }

  template <class Numbers, class PutOne>
  static char* put_tuple(char* place, const Numbers& numbers, const PutOne& put_one) {
    bool first = true;
    for (const auto number : numbers) {
      place = put_one(put_text(place, first ? "(" : ", "), number);
      first = false;
    }
    return put_text(place, ")");
  }
  static char* put_float(char* place, double value) {
    return put_coordinate(place, value, CoordinateType::kFloat32);
  }

  void write_usd_points() {
    list("    point3f[] points", header_.vertex_count, kUsdPointBytes,
         [&](std::uint64_t i, char* place) {
           const auto [x, y, z] = mesh_.stored_position(i);
           return put_tuple(place, std::array{x, y, z}, put_float);
         });
    writer_.text("\n");
  }

  void write_tets() {
    list("    int4[] tetVertexIndices", header_.tet_count, kUsdTetBytes,
         [&](std::uint64_t i, char* place) {
           return put_tuple(place, mesh_.tet(i), put_number<std::uint64_t>);
         });
    writer_.text("\n");
  }

  void write_faces() {
    list("    int3[] surfaceFaceVertexIndices", faces_.count(), kUsdFaceBytes,
         [&](std::uint64_t i, char* place) {
           return put_tuple(place, faces_.triangle(i), put_number<std::uint64_t>);
         });
    writer_.text("\n");
  }

  void write_primvar(std::size_t field) {
    const std::vector<std::string> names = names_in_file(names_of(header_.fields), kUsdNames);
    const std::size_t components = header_.fields[field].components;
    std::size_t before = 0;
    for (std::size_t i = 0; i < field; ++i) before += header_.fields[i].components;
    const std::size_t row_bytes = header_.field_values() * sizeof(float);
    const std::byte* const first = mesh_.fields.bytes().data() + before * sizeof(float);
    list(absl::StrCat("    ", components == 1 ? "float[]" : "vector3f[]",
                      " primvars:", names[field]),
         header_.vertex_count, kUsdValueBytes * components, [&](std::uint64_t i, char* place) {
           std::array<float, 3> values{};
           std::memcpy(values.data(), first + i * row_bytes, components * sizeof(float));
           return components == 1 ? put_float(place, static_cast<double>(values[0]))
                                  : put_tuple(place, values, put_float);
         });
    writer_.text(" (\n        interpolation = \"vertex\"\n    )\n");
  }

  void begin_subset(const std::string& name, const char* element, const char* family) {
    writer_.text(absl::StrCat("\n    def GeomSubset \"", name, "\"\n    {\n",
                              "        uniform token elementType = \"", element, "\"\n",
                              "        uniform token familyName = \"", family, "\"\n"));
  }

  /// Their names are of one list: they are prims of one parent.
  void write_subsets() {
    std::vector<std::string> names = names_of(tets_);
    std::ranges::copy(names_of(faces_.groups()), std::back_inserter(names));
    names = names_in_file(names, kUsdNames);
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      begin_subset(names[i], "tetrahedron", "regions");
      TetsOfGroup tets(mesh_, tets_[i]);
      list("        int[] indices", tets_[i].tets, kUsdIndexBytes,
           [&](std::uint64_t, char* place) { return put_number(place, tets.next()); });
      writer_.text("\n    }\n");
    }
    for (std::size_t i = 0; i < faces_.groups().size(); ++i) {
      const FaceGroup& group = faces_.groups()[i];
      begin_subset(names[tets_.size() + i], "face", "surfaces");
      list("        int[] indices", group.faces, kUsdIndexBytes,
           [&](std::uint64_t face, char* place) {
             return put_number(place, group.first + face);
           });
      writer_.text("\n    }\n");
    }
  }

  const TetMesh& mesh_;
  const MeshHeader& header_;
  std::vector<TetGroup> tets_;
  FaceGroups faces_;
  BlockWriter writer_;
};

}  // namespace

absl::Status write_usd(AtomicFile& file, const TetMesh& mesh, const WriteControl& control) {
  if (auto s = check_numbers({mesh}, kMostInt32, ".usda"); !s.ok()) return s;
  return UsdWriter(file, mesh, control).write();
}

}  // namespace tet
