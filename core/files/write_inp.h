// Abaqus' and CalculiX' input decks (.inp): the mesh and its sets, for decks that include it.
#pragma once

#include <array>
#include <string_view>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/files/file_names.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Both take 80 characters and read them as capitals.
inline constexpr std::array<std::string_view, 2> kInpOwnNames{"eall", "nall"};
inline constexpr NameRule kInpNames{
    .most_bytes = 80, .ignores_case = true, .taken = kInpOwnNames};

/// Writes C3D4 elements in an ELSET for each region or part, all of them in `Eall`, nodes in
/// `Nall`, and for each label of faces a SURFACE of element faces and an NSET, in world
/// coordinates. Numbers are ids plus one. `file` is left for the caller to commit.
///
/// Errors: kFailedPrecondition (Abaqus has 999,999,999 numbers for nodes and for elements).
absl::Status write_inp(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

}  // namespace tet
