#include "core/files/write_exodus.h"

#include <array>
#include <cstring>
#include <span>

#include <absl/strings/str_cat.h>

#include "core/files/big_endian.h"
#include "core/files/exodus_layout.h"
#include "core/files/number_limits.h"

namespace tet {
namespace {

/// The side opposite each corner: 1 is nodes 1-2-4, 2 is 2-3-4, 3 is 1-4-3 and 4 is 1-3-2.
constexpr std::array<std::int32_t, 4> kExodusSides{2, 3, 1, 4};

/// One for each value that a vertex has.
std::vector<std::string> exodus_variables(const MeshHeader& mesh) {
  const std::vector<std::string> names =
      array_names_in_file(names_of(mesh.fields), components_of(mesh.fields), kExodusFieldNames);
  std::vector<std::string> variables;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const std::string_view ending : component_endings(mesh.fields[i].components)) {
      variables.push_back(names[i] + std::string(ending));
    }
  }
  return variables;
}

std::vector<TetGroup> exodus_blocks(const TetMesh& mesh) {
  std::vector<TetGroup> blocks = tet_groups(mesh);
  std::erase_if(blocks, [](const TetGroup& block) { return block.tets == 0; });
  return blocks;
}

class ExodusWriter {
 public:
  ExodusWriter(AtomicFile& file, const FileMesh& mesh, const WriteControl& control)
      : nodes_(mesh),
        mesh_(mesh.mesh),
        shape_(mesh.shape()),
        is_wide_(file_coordinate_type(mesh_.header) == CoordinateType::kFloat64),
        faces_(mesh_, control.stop()),
        in_set_(shape_.nodes),
        parts_{.blocks = exodus_blocks(mesh_),
               .faces = faces_,
               .nodes_of_faces = count_nodes(control.stop()),
               .block_names = {},
               .face_names = names_in_file(names_of(faces_.groups()), kExodusNames),
               .variable_names = exodus_variables(mesh_.header)},
        layout_(lay_out()),
        writer_(file, layout_.header.file_bytes(), control) {}

  absl::Status write() {
    writer_.text(layout_.header.bytes());
    write_blocks();
    write_coordinates();
    if (faces_.count() > 0) write_sets();
    if (!parts_.variable_names.empty()) write_values();
    return writer_.status();
  }

 private:
  std::vector<std::uint64_t> count_nodes(const Cancellation& cancellation) {
    std::vector<std::uint64_t> counts(faces_.groups().size());
    for (std::size_t i = 0; i < counts.size() && !cancellation.requested(); ++i) {
      faces_.collect_nodes(nodes_, faces_.groups()[i], in_set_);
      counts[i] = in_set_.count();
    }
    return counts;
  }

  ExodusLayout lay_out() {
    parts_.block_names = names_in_file(names_of(parts_.blocks), kExodusNames);
    return lay_out_exodus(mesh_.header.tet_count, shape_, parts_,
                          is_wide_ ? NetcdfType::kDouble : NetcdfType::kFloat);
  }

  void at(NetcdfHeader::Variable variable) {
    writer_.move_to(layout_.header.offset_of(variable));
  }

  template <class IntOf>
  void ints(NetcdfHeader::Variable variable, std::uint64_t count, const IntOf& int_of) {
    at(variable);
    writer_.rows(count, [&](std::uint64_t i) {
      return big_endian(static_cast<std::int32_t>(int_of(i)));
    });
  }

  template <class RealOf>
  void reals(NetcdfHeader::Variable variable, std::uint64_t count, const RealOf& real_of) {
    at(variable);
    if (is_wide_) {
      writer_.rows(
          count, [&](std::uint64_t i) { return big_endian(static_cast<double>(real_of(i))); });
    } else {
      writer_.rows(count,
                   [&](std::uint64_t i) { return big_endian(static_cast<float>(real_of(i))); });
    }
  }

  /// Each in a row as long as any may be, and one for the end.
  void names(NetcdfHeader::Variable variable, const std::vector<std::string>& list) {
    at(variable);
    for (std::string name : list) {
      name.resize(kExodusNames.most_bytes + 1);
      writer_.text(name);
    }
  }

  template <class Group>
  void list(NetcdfHeader::Variable status,
            NetcdfHeader::Variable ids,
            const std::vector<Group>& groups) {
    ints(status, groups.size(), [](std::uint64_t) { return 1; });
    ints(ids, groups.size(), [&](std::uint64_t i) { return groups[i].tag; });
  }

  void write_blocks() {
    list(layout_.block_status, layout_.block_ids, parts_.blocks);
    names(layout_.block_names, parts_.block_names);
    for (std::size_t i = 0; i < parts_.blocks.size(); ++i) {
      at(layout_.connectivity[i]);
      TetsOfGroup tets(mesh_, parts_.blocks[i]);
      with_nodes_per_tet(nodes_, [&](auto count) {
        constexpr std::size_t kNodes = decltype(count)::value;
        writer_.rows(parts_.blocks[i].tets, [&](std::uint64_t) {
          std::array<std::int32_t, kNodes> row;
          std::ranges::transform(
              nodes_.template nodes_of<kNodes>(tets.next()), row.begin(),
              [](std::uint64_t node) { return static_cast<std::int32_t>(node + 1); });
          return big_endian(row);
        });
      });
    }
    at(layout_.element_numbers);
    for (const TetGroup& block : parts_.blocks) {
      TetsOfGroup tets(mesh_, block);
      writer_.rows(block.tets, [&](std::uint64_t) {
        return big_endian(static_cast<std::int32_t>(tets.next() + 1));
      });
    }
  }

  void write_coordinates() {
    const std::uint64_t count = shape_.nodes;
    reals(layout_.coordinates[0], count, [&](std::uint64_t i) { return nodes_.node(i).x; });
    reals(layout_.coordinates[1], count, [&](std::uint64_t i) { return nodes_.node(i).y; });
    reals(layout_.coordinates[2], count, [&](std::uint64_t i) { return nodes_.node(i).z; });
    names(layout_.coordinate_names, {"x", "y", "z"});
  }

  void write_sets() {
    const std::vector<FaceGroup>& groups = faces_.groups();
    list(layout_.side_status, layout_.side_ids, groups);
    list(layout_.node_status, layout_.node_ids, groups);
    names(layout_.side_names, parts_.face_names);
    names(layout_.node_names, parts_.face_names);
    const GroupedOrder order(mesh_);
    for (std::size_t i = 0; i < groups.size() && writer_.status().ok(); ++i) {
      const std::uint64_t first = groups[i].first, count = groups[i].faces;
      ints(layout_.side_elements[i], count,
           [&](std::uint64_t face) { return order.place_of(faces_[first + face].tet()) + 1; });
      ints(layout_.sides[i], count,
           [&](std::uint64_t face) { return kExodusSides[faces_[first + face].opposite()]; });
      faces_.collect_nodes(nodes_, groups[i], in_set_);
      std::uint64_t next = 0;
      ints(layout_.nodes[i], in_set_.count(), [&](std::uint64_t) {
        next = in_set_.next(next) + 1;
        return next;
      });
    }
  }

  void write_values() {
    names(layout_.variable_names, parts_.variable_names);
    reals(layout_.times, 1, [](std::uint64_t) { return 0; });
    for (std::size_t i = 0; i < layout_.values.size(); ++i) {
      reals(layout_.values[i], shape_.nodes, [&](std::uint64_t node) {
        float value = 0;
        std::memcpy(&value, nodes_.field_row(node) + i * sizeof(float), sizeof(value));
        return value;
      });
    }
  }

  const FileMesh& nodes_;
  const TetMesh& mesh_;
  FileShape shape_;
  bool is_wide_;
  FaceGroups faces_;
  RankMask in_set_;  ///< nodes
  ExodusParts parts_;
  ExodusLayout layout_;
  BlockWriter writer_;
};

}  // namespace

absl::Status write_exodus(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  if (auto status = check_numbers(mesh, kMostInt32, ".exo"); !status.ok()) return status;
  return ExodusWriter(file, mesh, control).write();
}

}  // namespace tet
