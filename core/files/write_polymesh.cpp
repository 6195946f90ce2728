#include "core/files/write_polymesh.h"

#include <functional>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/files/foam_faces.h"
#include "core/files/number_limits.h"
#include "core/files/tet_groups.h"
#include "core/files/text_numbers.h"

namespace tet {
namespace {

constexpr std::uint64_t kFoamPointBytes = 24, kFoamFaceBytes = 16, kFoamLabelBytes = 4;
constexpr std::uint64_t kFoamMemberBytes = 9;  ///< of a number as text, more or less

std::string foam_header(std::string_view of_class,
                        std::string_view object,
                        bool binary,
                        const std::string& note = "") {
  return absl::StrCat("FoamFile\n{\n    version     2.0;\n    format      ",
                      binary ? "binary" : "ascii", ";\n    class       ", std::string(of_class),
                      ";\n", binary ? "    arch        \"LSB;label=32;scalar=64\";\n" : "",
                      note, "    location    \"constant/polyMesh\";\n    object      ",
                      std::string(object), ";\n}\n\n");
}

class PolyMeshWriter {
 public:
  PolyMeshWriter(const AtomicFolder& folder, const TetMesh& mesh, const WriteControl& control)
      : folder_(folder),
        mesh_(mesh),
        control_(control),
        tets_(tet_groups(mesh)),
        faces_(mesh, control.stop()) {
    std::erase_if(tets_, [](const TetGroup& group) { return group.tets == 0; });
    std::uint64_t zoned = 0;
    for (const FoamZone& zone : faces_.zones()) zoned += zone.faces.size();
    total_bytes_ = mesh.header.vertex_count * kFoamPointBytes +
                   faces_.count() * (kFoamFaceBytes + kFoamLabelBytes) +
                   faces_.inner_count() * kFoamLabelBytes +
                   (mesh.header.tet_count + 2 * zoned) * kFoamMemberBytes;
  }

  absl::Status write() {
    absl::Status status =
        check_count(3 * faces_.count(), kMostInt32, "corners of faces", "polyMesh");
    if (status.ok()) status = file("points", [&](BlockWriter& to) { write_foam_points(to); });
    if (status.ok()) status = file("faces", [&](BlockWriter& to) { write_corners(to); });
    if (status.ok()) status = file("owner", [&](BlockWriter& to) { write_owners(to); });
    if (status.ok()) status = file("neighbour", [&](BlockWriter& to) { write_neighbours(to); });
    if (status.ok()) status = file("boundary", [&](BlockWriter& to) { write_patches(to); });
    if (status.ok()) status = file("cellZones", [&](BlockWriter& to) { write_cell_zones(to); });
    if (status.ok() && !faces_.zones().empty()) {
      status = file("faceZones", [&](BlockWriter& to) { write_face_zones(to); });
    }
    return status;
  }

 private:
  /// Writes a file whose progress goes on where that of the file before ended.
  absl::Status file(std::string_view name, const std::function<void(BlockWriter&)>& write) {
    absl::StatusOr<AtomicFile> file = folder_.file(name);
    if (!file.ok()) return file.status();
    double fraction = 0;
    WriteControl control{.cancellation = control_.cancellation, .progress = {}};
    control.progress = [&](double now) {
      fraction = now;
      if (control_.progress) control_.progress(done_ + now);
    };
    BlockWriter writer(*file, total_bytes_, control);
    write(writer);
    done_ += fraction;
    return writer.status().ok() ? file->commit_unsynced() : writer.status();
  }

  /// A list of labels in binary: its length, and the bytes in parentheses.
  template <class LabelOf>
  void labels(BlockWriter& writer, std::uint64_t count, const LabelOf& label_of) {
    begin_list(writer, count);
    more_labels(writer, count, label_of);
    writer.text(")\n");
  }
  void begin_list(BlockWriter& writer, std::uint64_t count) {
    writer.text(absl::StrCat(count, "\n("));
  }
  template <class LabelOf>
  void more_labels(BlockWriter& writer, std::uint64_t count, const LabelOf& label_of) {
    writer.rows(count, [&](std::uint64_t i) { return static_cast<std::int32_t>(label_of(i)); });
  }

  void write_foam_points(BlockWriter& writer) {
    writer.text(foam_header("vectorField", "points", true));
    begin_list(writer, mesh_.header.vertex_count);
    writer.rows(mesh_.header.vertex_count, [&](std::uint64_t i) {
      const auto [x, y, z] = mesh_.vertex(i);
      return std::array{x, y, z};
    });
    writer.text(")\n");
  }

  std::array<std::int32_t, 3> corners_of(std::uint64_t index) const noexcept {
    const auto [a, b, c] = face_of(mesh_.tet(index / 4), index % 4);
    return {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b),
            static_cast<std::int32_t>(c)};
  }

  /// Where each face begins among all corners, and the corners.
  void write_corners(BlockWriter& writer) {
    writer.text(foam_header("faceCompactList", "faces", true));
    labels(writer, faces_.count() + 1, [](std::uint64_t i) { return 3 * i; });
    begin_list(writer, 3 * faces_.count());
    InnerFoamFaces inner(faces_.behind());
    writer.rows(faces_.inner_count(),
                [&](std::uint64_t) { return corners_of(inner.next().index); });
    writer.rows(faces_.boundary().size(),
                [&](std::uint64_t i) { return corners_of(faces_.boundary()[i]); });
    writer.text(")\n");
  }

  /// OpenFOAM reads how many of everything there are before it reads the labels.
  std::string counts_note() const {
    return absl::StrCat("    note        \"nPoints:", mesh_.header.vertex_count,
                        "  nCells:", mesh_.header.tet_count, "  nFaces:", faces_.count(),
                        "  nInternalFaces:", faces_.inner_count(), "\";\n");
  }

  void write_owners(BlockWriter& writer) {
    writer.text(foam_header("labelList", "owner", true, counts_note()));
    begin_list(writer, faces_.count());
    InnerFoamFaces inner(faces_.behind());
    more_labels(writer, faces_.inner_count(),
                [&](std::uint64_t) { return inner.next().index / 4; });
    more_labels(writer, faces_.boundary().size(),
                [&](std::uint64_t i) { return faces_.boundary()[i] / 4; });
    writer.text(")\n");
  }

  void write_neighbours(BlockWriter& writer) {
    writer.text(foam_header("labelList", "neighbour", true, counts_note()));
    InnerFoamFaces inner(faces_.behind());
    labels(writer, faces_.inner_count(), [&](std::uint64_t) { return inner.next().behind; });
  }

  void write_patches(BlockWriter& writer) {
    const std::vector<FoamPatch>& patches = faces_.patches();
    const std::vector<std::string> names = names_in_file(names_of(patches), kFoamNames);
    std::string text = absl::StrCat(foam_header("polyBoundaryMesh", "boundary", false),
                                    patches.size(), "\n(\n");
    for (std::size_t i = 0; i < patches.size(); ++i) {
      absl::StrAppend(&text, "    ", names[i], "\n    {\n        type            patch;\n",
                      "        nFaces          ", patches[i].faces, ";\n");
      absl::StrAppend(&text, "        startFace       ",
                      faces_.inner_count() + patches[i].first, ";\n    }\n");
    }
    writer.text(text + ")\n");
  }

  /// The members of a zone as text, in parentheses.
  template <class Next>
  void members(BlockWriter& writer,
               std::string_view what,
               std::uint64_t count,
               const Next& next) {
    writer.text(absl::StrCat("        ", std::string(what), "\n", count, "\n(\n"));
    writer.lines(count, kFoamMemberBytes, [&](std::uint64_t i, char* place) {
      return put_text(put_number(place, std::uint64_t{next(i)}), "\n");
    });
    writer.text(")\n;\n");
  }

  void write_cell_zones(BlockWriter& writer) {
    const std::vector<std::string> names = names_in_file(names_of(tets_), kFoamNames);
    writer.text(foam_header("regIOobject", "cellZones", false));
    writer.text(absl::StrCat(tets_.size(), "\n(\n"));
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      writer.text(absl::StrCat("    ", names[i], "\n    {\n        type cellZone;\n"));
      TetsOfGroup tets(mesh_, tets_[i]);
      members(writer, "cellLabels List<label>", tets_[i].tets,
              [&](std::uint64_t) { return tets.next(); });
      writer.text("    }\n");
    }
    writer.text(")\n");
  }

  void write_face_zones(BlockWriter& writer) {
    const std::vector<FoamZone>& zones = faces_.zones();
    const std::vector<std::string> names = names_in_file(names_of(zones), kFoamNames);
    writer.text(foam_header("regIOobject", "faceZones", false));
    writer.text(absl::StrCat(zones.size(), "\n(\n"));
    for (std::size_t i = 0; i < zones.size(); ++i) {
      writer.text(absl::StrCat("    ", names[i], "\n    {\n        type faceZone;\n"));
      const std::vector<FoamZone::Face>& faces = zones[i].faces;
      members(writer, "faceLabels List<label>", faces.size(),
              [&](std::uint64_t face) { return faces[face].number; });
      members(writer, "flipMap List<bool>", faces.size(),
              [&](std::uint64_t face) { return faces[face].flipped ? 1U : 0U; });
      writer.text("    }\n");
    }
    writer.text(")\n");
  }

  const AtomicFolder& folder_;
  const TetMesh& mesh_;
  const WriteControl& control_;
  std::vector<TetGroup> tets_;
  FoamFaces faces_;
  std::uint64_t total_bytes_ = 0;
  double done_ = 0;
};

}  // namespace

absl::Status write_polymesh(const AtomicFolder& folder,
                            const TetMesh& mesh,
                            const WriteControl& control) {
  if (auto status = check_numbers({mesh}, kMostInt32, "polyMesh"); !status.ok()) {
    return status;
  }
  // A face is of two tets at most: a mesh that is beyond the limit for certain is refused
  // before its faces are looked for.
  const std::uint64_t fewest = 6 * mesh.header.tet_count;
  if (auto status = check_count(fewest, kMostInt32, "corners of faces", "polyMesh");
      !status.ok()) {
    return status;
  }
  return PolyMeshWriter(folder, mesh, control).write();
}

}  // namespace tet
