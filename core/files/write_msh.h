// Gmsh's mesh format (.msh) 4.1, binary.
#pragma once

#include <cstdint>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/files/file_names.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The format lets a physical name have 127 bytes; readers fail on fewer, as they count quotes.
inline constexpr NameRule kMshNames{.most_bytes = 120,
                                    .letter_first = false,
                                    .bad_characters = "\"\n\r",
                                    .in_their_place = '\''};

/// Writes the whole mesh as one volume entity, the physical volume "inside" (1). A mesh with
/// regions becomes two, "inside" (1) and "outside" (2); one of several grids becomes a physical
/// volume for each, with the grid's name. The boundary's triangles are written as a surface and
/// a physical surface for each of their labels. `file` is left for the caller to commit.
///
/// Tags are ids plus one, since Gmsh counts from one; coordinates are float64, the only kind it
/// knows. Each volume's tets come together, in the mesh's order; all nodes are in the first.
absl::Status write_msh(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

/// Where the columns of a file begin: its nodes' numbers and points, the elements of each
/// volume and of each surface, and the values of each field.
struct MshColumns {
  std::uint64_t tet_count = 0;
  std::uint64_t numbers = 0, points = 0;
  std::vector<std::uint64_t> volumes = {}, surfaces = {}, fields = {};
};

/// Whether a mesh can be written while it is made. A file counts the elements of each volume
/// and surface before it has the first node, so that the mesh's faces have to come with its
/// parts, all of one name, as its tets have to be.
bool msh_takes_parts(const MeshHeader& header) noexcept;

/// Writes everything of such a mesh's file but the rows of its columns. Errors:
/// kInvalidArgument (more nodes than the format can number), and the writer's.
absl::StatusOr<MshColumns> begin_msh_of_parts(BlockWriter& writer, const MeshHeader& header);

/// Writes the rows of some vertices, tets and faces (their ids are those of the whole mesh).
/// Thread-safe, with a writer for each thread.
void write_msh_part(BlockWriter& writer,
                    const MshColumns& columns,
                    const TetMesh& part,
                    const ChunkExtent& place);

}  // namespace tet
