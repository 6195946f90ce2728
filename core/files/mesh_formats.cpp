#include "core/files/mesh_formats.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <absl/status/status.h>
#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>

#include "core/base/check.h"

namespace tet {
namespace {

constexpr std::array kRows{
    MeshFormatRow{.format = MeshFormat::kVtu,
                  .name = "vtu",
                  .ending = ".vtu",
                  .about = "VTK, ParaView",
                  .tets = "all",
                  .second_order = "`VTK_QUADRATIC_TETRA`",
                  .regions = "cell data `region`, `part` or `label`",
                  .faces = "",
                  .fields = "point data, float32",
                  .coordinates = "float32, or float64 where that is needed",
                  .names = ""},
    MeshFormatRow{.format = MeshFormat::kVtkHdf,
                  .name = "vtkhdf",
                  .ending = ".vtkhdf",
                  .about = "VTK, ParaView",
                  .tets = "all",
                  .second_order = "`VTK_QUADRATIC_TETRA`",
                  .regions = "cell data `region`, `part` or `label`",
                  .faces = "",
                  .fields = "point data, float32",
                  .coordinates = "float32, or float64 where that is needed",
                  .names = "a `/` becomes `_`, and so does a part called `.`"},
    MeshFormatRow{.format = MeshFormat::kMsh,
                  .name = "msh",
                  .ending = ".msh",
                  .about = "Gmsh 4.1",
                  .tets = "all",
                  .second_order = "types 11 and 9",
                  .regions = "physical volumes",
                  .faces = "physical surfaces",
                  .fields = "`$NodeData`, float64",
                  .coordinates = "float64",
                  .names = "120 bytes; a `\"` becomes `'`"},
    MeshFormatRow{.format = MeshFormat::kInp,
                  .name = "inp",
                  .ending = ".inp",
                  .about = "Abaqus, CalculiX",
                  .tets = "all",
                  .second_order = "`C3D10`",
                  .regions = "an `ELSET` each, and `Eall`",
                  .faces = "a `SURFACE` and an `NSET` each",
                  .fields = "",
                  .coordinates = "text of at most 20 characters: float32, or float64 but for "
                                 "the last digits where that is needed",
                  .names = "80 letters, digits and `_`"},
    MeshFormatRow{.format = MeshFormat::kXdmf,
                  .name = "xdmf",
                  .ending = ".xdmf",
                  .about = "dolfinx (FEniCS), ParaView; with an `.h5` beside it",
                  .tets = "all",
                  .second_order = "`Tetrahedron_10`, `Triangle_6`",
                  .regions = "tags, grid `cell_tags`",
                  .faces = "tags, grid `facet_tags`",
                  .fields = "node attributes, float32",
                  .coordinates = "float32, or float64 where that is needed",
                  .names = ""},
    MeshFormatRow{.format = MeshFormat::kExodus,
                  .name = "exodus",
                  .ending = ".exo",
                  .more = ".e .ex2",
                  .about = "MOOSE, Sierra, ParaView",
                  .tets = "all",
                  .second_order = "`TETRA10`",
                  .regions = "element blocks",
                  .faces = "a side set and a node set each",
                  .fields = "nodal variables, a vector three of them",
                  .coordinates = "float32, or float64 where that is needed",
                  .names = "32 letters, digits and `_`"},
    MeshFormatRow{.format = MeshFormat::kPolyMesh,
                  .name = "polymesh",
                  .ending = ".polyMesh",
                  .about = "OpenFOAM; a folder, which may be called `polyMesh` alone",
                  .tets = "all",
                  .regions = "zones of cells",
                  .faces = "a patch each; zones of those between tets",
                  .fields = "",
                  .coordinates = "float64",
                  .names = "80 letters, digits and `_`"},
    MeshFormatRow{.format = MeshFormat::kMfem,
                  .name = "mfem",
                  .ending = ".mesh",
                  .about = "MFEM, version 1.0",
                  .tets = "all",
                  .regions = "attributes; names as comments",
                  .faces = "boundary attributes; names as comments",
                  .fields = "",
                  .coordinates = "text: float32, or float64 where that is needed",
                  .names = ""},
    MeshFormatRow{.format = MeshFormat::kUsd,
                  .name = "usd",
                  .ending = ".usda",
                  .about = "Universal Scene Description: a TetMesh",
                  .tets = "all",
                  .regions = "a GeomSubset of tets each",
                  .faces = "a GeomSubset of faces each",
                  .fields = "primvars, float32",
                  .coordinates = "text: float32, beside a translation in float64",
                  .names = "80 letters, digits and `_`"},
    MeshFormatRow{.format = MeshFormat::kStl,
                  .name = "stl",
                  .ending = ".stl",
                  .about = "nearly everything",
                  .tets = "",
                  .regions = "",
                  .faces = "the triangles, without names",
                  .fields = "",
                  .coordinates = "float32",
                  .names = ""},
    MeshFormatRow{.format = MeshFormat::kPly,
                  .name = "ply",
                  .ending = ".ply",
                  .about = "MeshLab, Blender",
                  .tets = "",
                  .regions = "",
                  .faces = "the triangles, with property `label`; names as comments",
                  .fields = "properties of vertices, float32",
                  .coordinates = "float32, or float64 where that is needed",
                  .names = "letters, digits and `_` in fields"},
    MeshFormatRow{.format = MeshFormat::kObj,
                  .name = "obj",
                  .ending = ".obj",
                  .about = "Blender, Maya",
                  .tets = "",
                  .regions = "",
                  .faces = "the triangles, a group each",
                  .fields = "",
                  .coordinates = "text: float32, or float64 where that is needed",
                  .names = "letters, digits and `_`"},
};

/// A path's ending in small letters. Where OpenFOAM looks for it, a polyMesh has that name
/// alone.
std::string ending_of(const std::string& path) {
  const std::filesystem::path name = std::filesystem::path(path);
  const std::string ending = absl::AsciiStrToLower(name.extension().string());
  return ending.empty() && name.filename() == "polyMesh" ? ".polymesh" : ending;
}

std::string text_of(std::string_view view) { return std::string(view); }

/// The one that it gives files, and the others that it takes, as they are written.
std::vector<std::string> endings_of(const MeshFormatRow& row) {
  std::vector<std::string> endings{text_of(row.ending)};
  for (const auto more : absl::StrSplit(text_of(row.more), ' ', absl::SkipEmpty())) {
    endings.emplace_back(more);
  }
  return endings;
}

bool takes_ending(const MeshFormatRow& row, const std::string& ending) {
  return std::ranges::any_of(endings_of(row), [&](const std::string& each) {
    return absl::AsciiStrToLower(each) == ending;
  });
}

std::string cell(std::string_view said, const char* nothing = "-") {
  return said.empty() ? nothing : text_of(said);
}

}  // namespace

std::span<const MeshFormatRow> mesh_formats() { return kRows; }

const MeshFormatRow& row_of(MeshFormat format) {
  const auto row = std::ranges::find(kRows, format, &MeshFormatRow::format);
  TET_CHECK(row != kRows.end());
  return *row;
}

std::vector<std::string> mesh_format_names() {
  std::vector<std::string> names;
  names.reserve(kRows.size());
  for (const MeshFormatRow& row : kRows) names.push_back(text_of(row.name));
  return names;
}

absl::StatusOr<MeshFormat> mesh_format_named(std::string_view name) {
  const auto row = std::ranges::find(kRows, name, &MeshFormatRow::name);
  if (row != kRows.end()) return row->format;
  return absl::InvalidArgumentError(absl::StrCat("there is no mesh format ", std::string(name),
                                                 "; there are ",
                                                 absl::StrJoin(mesh_format_names(), ", ")));
}

absl::StatusOr<MeshFormat> mesh_format_of(const std::string& path) {
  const std::string ending = ending_of(path);
  const auto row = std::ranges::find_if(
      kRows, [&](const MeshFormatRow& each) { return takes_ending(each, ending); });
  if (row != kRows.end()) return row->format;
  return absl::InvalidArgumentError(
      absl::StrCat("the output ", path, " ends in ", ending.empty() ? "nothing" : ending,
                   "; it must end in ", list_endings(),
                   ", which chooses the format, unless a format is named"));
}

std::string list_endings(const std::string& last) {
  std::string text;
  for (const MeshFormatRow& row : kRows) {
    const bool is_last = &row == &kRows.back();
    const std::string between = is_last ? absl::StrCat(" ", last, " ") : ", ";
    absl::StrAppend(&text, text.empty() ? "" : between, text_of(row.ending));
  }
  return text;
}

std::string describe_mesh_formats() {
  std::string text =
      "| format | ending | for | tets | order 2 | regions and parts | faces | fields | "
      "coordinates | names |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const MeshFormatRow& row : kRows) {
    const std::vector<std::string> cells{
        absl::StrCat("`", text_of(row.name), "`"),
        absl::StrCat("`", absl::StrJoin(endings_of(row), "`, `"), "`"),
        cell(row.about),
        cell(row.tets),
        cell(row.second_order),
        cell(row.regions),
        cell(row.faces),
        cell(row.fields),
        cell(row.coordinates),
        cell(row.names, "any")};
    absl::StrAppend(&text, "| ", absl::StrJoin(cells, " | "), " |\n");
  }
  return text;
}

}  // namespace tet
