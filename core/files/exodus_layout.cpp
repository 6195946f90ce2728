#include "core/files/exodus_layout.h"

#include <absl/strings/str_cat.h>

#include "core/files/write_exodus.h"

namespace tet {
namespace {

/// Dimensions that several variables have.
struct ExodusDimensions {
  NetcdfHeader::Dimension name, time, space, nodes, elements;
  std::size_t nodes_per_tet;
};

std::string numbered(const char* name, std::size_t i) { return absl::StrCat(name, i + 1); }

/// Ids, whether there is anything in each, and names, of blocks or sets.
struct ListOfSets {
  NetcdfHeader::Variable status, ids, names;
};

ListOfSets add_list(NetcdfHeader& header,
                    const std::string& prefix,
                    const char* counted,
                    std::size_t count,
                    NetcdfHeader::Dimension name) {
  const auto sets = header.add_dimension(counted, count);
  const auto status = header.add_variable(prefix + "_status", NetcdfType::kInt, {sets});
  const auto ids = header.add_variable(prefix + "_prop1", NetcdfType::kInt, {sets},
                                       {text_attribute("name", "ID")});
  const auto names = header.add_variable(prefix + "_names", NetcdfType::kChar, {sets, name});
  return {status, ids, names};
}

void add_blocks(ExodusLayout& layout, const ExodusParts& parts, const ExodusDimensions& sizes) {
  NetcdfHeader& header = layout.header;
  const ListOfSets list = add_list(header, "eb", "num_el_blk", parts.blocks.size(), sizes.name);
  layout.block_status = list.status;
  layout.block_ids = list.ids;
  layout.block_names = list.names;
  for (std::size_t i = 0; i < parts.blocks.size(); ++i) {
    const auto tets = header.add_dimension(numbered("num_el_in_blk", i), parts.blocks[i].tets);
    const auto corners =
        header.add_dimension(numbered("num_nod_per_el", i), sizes.nodes_per_tet);
    const char* const type = sizes.nodes_per_tet == 4 ? "TETRA" : "TETRA10";
    layout.connectivity.push_back(header.add_variable(numbered("connect", i), NetcdfType::kInt,
                                                      {tets, corners},
                                                      {text_attribute("elem_type", type)}));
  }
  layout.element_numbers =
      header.add_variable("elem_num_map", NetcdfType::kInt, {sizes.elements});
}

void add_sets(ExodusLayout& layout, const ExodusParts& parts, const ExodusDimensions& sizes) {
  NetcdfHeader& header = layout.header;
  const std::vector<FaceGroup>& groups = parts.faces.groups();
  if (groups.empty()) return;
  const ListOfSets sides = add_list(header, "ss", "num_side_sets", groups.size(), sizes.name);
  layout.side_status = sides.status;
  layout.side_ids = sides.ids;
  layout.side_names = sides.names;
  const ListOfSets nodes = add_list(header, "ns", "num_node_sets", groups.size(), sizes.name);
  layout.node_status = nodes.status;
  layout.node_ids = nodes.ids;
  layout.node_names = nodes.names;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto faces = header.add_dimension(numbered("num_side_ss", i), groups[i].faces);
    layout.side_elements.push_back(
        header.add_variable(numbered("elem_ss", i), NetcdfType::kInt, {faces}));
    layout.sides.push_back(
        header.add_variable(numbered("side_ss", i), NetcdfType::kInt, {faces}));
    const auto count = header.add_dimension(numbered("num_nod_ns", i), parts.nodes_of_faces[i]);
    layout.nodes.push_back(
        header.add_variable(numbered("node_ns", i), NetcdfType::kInt, {count}));
  }
}

void add_values(ExodusLayout& layout,
                const ExodusParts& parts,
                const ExodusDimensions& sizes,
                NetcdfType real) {
  NetcdfHeader& header = layout.header;
  layout.times = header.add_variable("time_whole", real, {sizes.time});
  const std::size_t count = parts.variable_names.size();
  if (count == 0) return;
  const auto variables = header.add_dimension("num_nod_var", count);
  layout.variable_names =
      header.add_variable("name_nod_var", NetcdfType::kChar, {variables, sizes.name});
  for (std::size_t i = 0; i < count; ++i) {
    layout.values.push_back(
        header.add_variable(numbered("vals_nod_var", i), real, {sizes.time, sizes.nodes}));
  }
}

}  // namespace

ExodusLayout lay_out_exodus(std::uint64_t tets,
                            const FileShape& shape,
                            const ExodusParts& parts,
                            NetcdfType real) {
  constexpr float kVersion = 8.03F;  // of the format and of the library that it is like
  constexpr std::int32_t kMostNameBytes = static_cast<std::int32_t>(kExodusNames.most_bytes);
  ExodusLayout layout;
  NetcdfHeader& header = layout.header;
  header.add_attribute(float_attribute("api_version", kVersion));
  header.add_attribute(float_attribute("version", kVersion));
  header.add_attribute(
      int_attribute("floating_point_word_size", static_cast<std::int32_t>(size_of(real))));
  header.add_attribute(int_attribute("file_size", 1));  // offsets of 64 bits
  header.add_attribute(int_attribute("maximum_name_length", kMostNameBytes));
  header.add_attribute(int_attribute("int64_status", 0));
  header.add_attribute(text_attribute("title", "a mesh, written by tetstream"));
  header.add_dimension("len_string", 33);
  header.add_dimension("len_line", 81);
  header.add_dimension("four", 4);
  const std::uint64_t steps = parts.variable_names.empty() ? 0 : 1;
  const ExodusDimensions sizes{.name = header.add_dimension("len_name", kMostNameBytes + 1),
                               .time = header.add_steps("time_step", steps),
                               .space = header.add_dimension("num_dim", 3),
                               .nodes = header.add_dimension("num_nodes", shape.nodes),
                               .elements = header.add_dimension("num_elem", tets),
                               .nodes_per_tet = shape.nodes_per_tet};
  add_blocks(layout, parts, sizes);
  for (const char* const name : {"coordx", "coordy", "coordz"}) {
    layout.coordinates.push_back(header.add_variable(name, real, {sizes.nodes}));
  }
  layout.coordinate_names =
      header.add_variable("coor_names", NetcdfType::kChar, {sizes.space, sizes.name});
  add_sets(layout, parts, sizes);
  add_values(layout, parts, sizes, real);
  header.lay_out();
  return layout;
}

}  // namespace tet
