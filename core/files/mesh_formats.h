// What mesh files there are, and what each carries: the one table that the command's help and
// completions, messages, documents and tests read.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

namespace tet {

enum class MeshFormat : std::uint8_t {
  kVtu,
  kVtkHdf,
  kMsh,
  kInp,
  kXdmf,
  kExodus,
  kPolyMesh,
  kMfem,
  kUsd,
  kStl,
  kPly,
  kObj,
};

/// A row of the table. What is said of a thing that a format does not carry is empty.
struct MeshFormatRow {
  MeshFormat format;
  std::string_view name;       ///< what --format takes
  std::string_view ending;     ///< with its dot
  std::string_view more = {};  ///< other endings that are taken, a space between them
  std::string_view about;      ///< whose it is, or who reads it
  std::string_view tets;       ///< empty: the boundary alone
  /// How it calls tets of ten nodes; empty: it gets none.
  std::string_view second_order = {};
  std::string_view regions;  ///< how it says which region or part a tet is of
  std::string_view faces;    ///< how it names boundary faces
  std::string_view fields;   ///< how it has values at vertices
  std::string_view coordinates;
  std::string_view names;  ///< what names may be like; empty: as they are
};

/// In the order in which they are listed.
std::span<const MeshFormatRow> mesh_formats();

const MeshFormatRow& row_of(MeshFormat format);

/// All that --format takes.
std::vector<std::string> mesh_format_names();

/// The format of this --format. Errors: kInvalidArgument; the message lists them.
absl::StatusOr<MeshFormat> mesh_format_named(std::string_view name);

/// The format that a path's ending chooses, in any case. Errors: kInvalidArgument (another
/// ending); the message lists them.
absl::StatusOr<MeshFormat> mesh_format_of(const std::string& path);

/// ".vtu, .vtkhdf or .msh": all endings, with `last` before the last.
std::string list_endings(const std::string& last = "or");

/// The whole table in Markdown, which is made to be read as it is, too.
std::string describe_mesh_formats();

}  // namespace tet
