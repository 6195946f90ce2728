// The dimensions and variables of an Exodus file, before any of them is filled.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/files/face_groups.h"
#include "core/files/mesh_columns.h"
#include "core/files/netcdf_header.h"
#include "core/files/tet_groups.h"

namespace tet {

/// What the file is about.
struct ExodusParts {
  std::vector<TetGroup> blocks;  ///< those with tets
  const FaceGroups& faces;
  std::vector<std::uint64_t> nodes_of_faces;  ///< of each group: how many nodes it has
  std::vector<std::string> block_names, face_names, variable_names;
};

/// A variable of each thing in a list.
using NetcdfVariables = std::vector<NetcdfHeader::Variable>;

struct ExodusLayout {
  NetcdfHeader header;
  NetcdfHeader::Variable block_status = 0, block_ids = 0, block_names = 0;
  NetcdfVariables connectivity;
  NetcdfHeader::Variable element_numbers = 0;
  NetcdfVariables coordinates;
  NetcdfHeader::Variable coordinate_names = 0;
  // These are laid out where there are faces.
  NetcdfHeader::Variable side_status = 0, side_ids = 0, side_names = 0;
  NetcdfVariables side_elements, sides;
  NetcdfHeader::Variable node_status = 0, node_ids = 0, node_names = 0;
  NetcdfVariables nodes;
  // These are laid out where there are fields, but for the times.
  NetcdfHeader::Variable variable_names = 0;
  NetcdfVariables values;
  NetcdfHeader::Variable times = 0;
};

ExodusLayout lay_out_exodus(std::uint64_t tets,
                            const FileShape& shape,
                            const ExodusParts& parts,
                            NetcdfType real);

}  // namespace tet
