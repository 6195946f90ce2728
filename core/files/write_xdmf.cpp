#include "core/files/write_xdmf.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/face_groups.h"
#include "core/files/hdf5_outline.h"
#include "core/files/mesh_columns.h"
#include "core/files/tet_groups.h"

namespace tet {
namespace {

/// The columns of the HDF5 file.
struct XdmfLayout {
  using Column = Hdf5Outline::Column;
  static constexpr Column kNoColumn = Hdf5Outline::kNoColumn;

  Column topology = kNoColumn, geometry = kNoColumn, cell_tags = kNoColumn;
  Column facets = kNoColumn, facet_tags = kNoColumn;
  std::vector<Column> fields = {};
};

std::string xdmf_text(const std::string& name) {
  return absl::StrReplaceAll(name,
                             {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

class XdmfWriter {
 public:
  XdmfWriter(AtomicFile& columns, const FileMesh& mesh, const WriteControl& control)
      : columns_(columns),
        nodes_(mesh),
        mesh_(mesh.mesh),
        header_(mesh_.header),
        shape_(mesh.shape()),
        types_(choose_column_types(header_, shape_)),
        tets_(tet_groups(mesh_)),
        faces_(mesh_, control.stop()),
        writer_(columns, column_bytes(), control) {}

  absl::Status write_columns() {
    if (!writer_.goes_on()) return writer_.status();  // the faces may not have been found
    Hdf5Outline outline("Mesh");
    const XdmfLayout layout = lay_out_columns(outline);
    const auto places =
        put_outline(columns_, writer_, column_bytes(), header_.fields.size(), outline);
    if (!places.ok()) return places.status();
    const auto fill = [&](XdmfLayout::Column column, const std::function<void()>& write) {
      write_at(writer_, places->of(column, 0, 0), write);
    };
    fill(layout.geometry, [&] { write_points(writer_, nodes_, types_.coordinates); });
    fill(layout.topology, [&] { write_connectivity(writer_, nodes_, types_.ids); });
    fill(layout.cell_tags, [&] { write_cell_tags(); });
    fill(layout.facets, [&] { write_facets(); });
    fill(layout.facet_tags, [&] { write_facet_tags(); });
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      fill(layout.fields[i], [&] { write_field(writer_, nodes_, i); });
    }
    return writer_.status();
  }

  std::string index_text(const std::string& columns_name) const {
    const std::string file = xdmf_text(columns_name);
    const bool second = shape_.nodes_per_tet == 10;
    const std::string tets = topology(file, second ? "Tetrahedron_10" : "Tetrahedron",
                                      shape_.nodes_per_tet, header_.tet_count, "topology");
    const std::string points = geometry(file);
    std::string text = absl::StrCat(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n",
        "    <Grid Name=\"mesh\" GridType=\"Uniform\">\n", tets, points, fields(file),
        "    </Grid>\n", "    <Grid Name=\"cell_tags\" GridType=\"Uniform\">\n", tets, points,
        tags(file, "cell_tags", header_.tet_count), names_of_tags(tets_), "    </Grid>\n");
    if (faces_.count() > 0) {
      absl::StrAppend(&text, "    <Grid Name=\"facet_tags\" GridType=\"Uniform\">\n",
                      topology(file, second ? "Triangle_6" : "Triangle", nodes_per_face(),
                               faces_.count(), "facets"),
                      points, tags(file, "facet_tags", faces_.count()),
                      names_of_tags(faces_.groups()), "    </Grid>\n");
    }
    return absl::StrCat(text, "  </Domain>\n</Xdmf>\n");
  }

 private:
  std::size_t nodes_per_face() const { return shape_.nodes_per_tet == 10 ? 6 : 3; }

  std::uint64_t column_bytes() const {
    const ColumnSizes sizes = column_sizes(header_, shape_, types_, 0);
    return sizes.points + sizes.connectivity + sizes.fields +
           sizeof(std::int32_t) * (header_.tet_count + faces_.count()) +
           nodes_per_face() * size_of(types_.ids) * faces_.count();
  }

  XdmfLayout lay_out_columns(Hdf5Outline& outline) const {
    const bool wide = types_.coordinates == CoordinateType::kFloat64;
    const Hdf5Type real = wide ? Hdf5Type::kFloat64 : Hdf5Type::kFloat32;
    const Hdf5Type id = types_.ids == IndexType::kUint64 ? Hdf5Type::kInt64 : Hdf5Type::kInt32;
    const std::uint64_t tets = header_.tet_count, faces = faces_.count();
    XdmfLayout layout{.topology = outline.column("topology", id, {tets, shape_.nodes_per_tet}),
                      .geometry = outline.column("geometry", real, {shape_.nodes, 3}),
                      .cell_tags = outline.column("cell_tags", Hdf5Type::kInt32, {tets})};
    if (faces > 0) {
      layout.facets = outline.column("facets", id, {faces, nodes_per_face()});
      layout.facet_tags = outline.column("facet_tags", Hdf5Type::kInt32, {faces});
    }
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      const std::uint64_t components = header_.fields[i].components;
      layout.fields.push_back(outline.column(absl::StrCat("field_", i), Hdf5Type::kFloat32,
                                             {shape_.nodes, components}));
    }
    return layout;
  }

  void write_cell_tags() {
    if (header_.has_regions) {
      writer_.rows_side_by_side(header_.tet_count, [&](std::uint64_t i) {
        return static_cast<std::int32_t>(mesh_.region(i));
      });
      return;
    }
    if (!header_.labels.empty()) {
      writer_.rows_side_by_side(header_.tet_count,
                                [tags = tags_of_labels(header_), this](std::uint64_t i) {
                                  return tags[mesh_.label(i)];
                                });
      return;
    }
    for (const TetGroup& group : tets_) {
      writer_.rows_side_by_side(group.tets, [&](std::uint64_t) { return group.tag; });
    }
  }

  void write_facets() {
    with_nodes_per_tet(nodes_, [&](auto nodes) {
      constexpr std::size_t kNodes = decltype(nodes)::value;
      types_.ids == IndexType::kUint64 ? write_facets_as<std::uint64_t, kNodes>()
                                       : write_facets_as<std::uint32_t, kNodes>();
    });
  }

  template <class Id, std::size_t kNodes>
  void write_facets_as() {
    writer_.rows_side_by_side(faces_.count(), [&](std::uint64_t i) {
      const auto of_tet = nodes_.template nodes_of<kNodes>(faces_[i].tet());
      const auto nodes = nodes_of_face(of_tet, faces_[i].opposite());
      std::array<Id, nodes.size()> ids;
      std::ranges::transform(nodes, ids.begin(),
                             [](std::uint64_t each) { return static_cast<Id>(each); });
      return ids;
    });
  }

  void write_facet_tags() {
    for (const FaceGroup& group : faces_.groups()) {
      writer_.rows_side_by_side(group.faces, [&](std::uint64_t) { return group.tag; });
    }
  }

  static std::string data_item(const std::string& file,
                               const std::string& dimensions,
                               const std::string& type,
                               const std::string& dataset) {
    return absl::StrCat("        <DataItem Dimensions=\"", dimensions, "\" ", type,
                        " Format=\"HDF\">", file, ":/Mesh/", dataset, "</DataItem>\n");
  }

  std::string topology(const std::string& file,
                       const char* cells,
                       std::size_t nodes,
                       std::uint64_t count,
                       const char* dataset) const {
    const std::string type =
        absl::StrCat("NumberType=\"Int\" Precision=\"", size_of(types_.ids), "\"");
    return absl::StrCat("      <Topology TopologyType=\"", cells, "\" NumberOfElements=\"",
                        count, "\" NodesPerElement=\"", nodes, "\">\n",
                        data_item(file, absl::StrCat(count, " ", nodes), type, dataset),
                        "      </Topology>\n");
  }

  std::string geometry(const std::string& file) const {
    const std::string type =
        absl::StrCat("NumberType=\"Float\" Precision=\"", size_of(types_.coordinates), "\"");
    return absl::StrCat("      <Geometry GeometryType=\"XYZ\">\n",
                        data_item(file, absl::StrCat(shape_.nodes, " 3"), type, "geometry"),
                        "      </Geometry>\n");
  }

  std::string fields(const std::string& file) const {
    std::string text;
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      const FieldArray& field = header_.fields[i];
      absl::StrAppend(
          &text, "      <Attribute Name=\"", xdmf_text(field.name), "\" AttributeType=\"",
          field.components == 1 ? "Scalar" : "Vector", "\" Center=\"Node\">\n",
          data_item(file, absl::StrCat(shape_.nodes, " ", field.components),
                    "NumberType=\"Float\" Precision=\"4\"", absl::StrCat("field_", i)),
          "      </Attribute>\n");
    }
    return text;
  }

  static std::string tags(const std::string& file, const char* name, std::uint64_t count) {
    return absl::StrCat(
        "      <Attribute Name=\"", name, "\" AttributeType=\"Scalar\" Center=\"Cell\">\n",
        data_item(file, absl::StrCat(count), "NumberType=\"Int\" Precision=\"4\"", name),
        "      </Attribute>\n");
  }

  template <class Group>
  static std::string names_of_tags(const std::vector<Group>& groups) {
    std::string text;
    for (const Group& group : groups) {
      absl::StrAppend(&text, "      <Information Name=\"", group.tag, "\" Value=\"",
                      xdmf_text(group.name), "\"/>\n");
    }
    return text;
  }

  AtomicFile& columns_;
  const FileMesh& nodes_;
  const TetMesh& mesh_;
  const MeshHeader& header_;
  FileShape shape_;
  ColumnTypes types_;
  std::vector<TetGroup> tets_;
  FaceGroups faces_;
  BlockWriter writer_;
};

}  // namespace

absl::Status write_xdmf(AtomicFile& index,
                        AtomicFile& columns,
                        const std::string& columns_name,
                        const FileMesh& mesh,
                        const WriteControl& control) {
  XdmfWriter writer(columns, mesh, control);
  if (absl::Status status = writer.write_columns(); !status.ok()) return status;
  const std::string text = writer.index_text(columns_name);
  return index.write(std::as_bytes(std::span(text)));
}

}  // namespace tet
