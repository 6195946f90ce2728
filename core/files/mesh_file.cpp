#include "core/files/mesh_file.h"

#include <filesystem>
#include <optional>
#include <span>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>

#include "core/files/file_names.h"
#include "core/files/hdf5_part.h"
#include "core/files/write_boundary.h"
#include "core/files/write_exodus.h"
#include "core/files/write_inp.h"
#include "core/files/write_mfem.h"
#include "core/files/write_msh.h"
#include "core/files/write_polymesh.h"
#include "core/files/write_usd.h"
#include "core/files/write_vtkhdf.h"
#include "core/files/write_vtu.h"
#include "core/files/write_xdmf.h"
#include "core/mesh/find_faces.h"
#include "core/mesh/label_faces.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

using FileWriter = absl::Status (*)(AtomicFile&, const FileMesh&, const WriteControl&);

/// The writer of a format that has meshes of first order alone.
template <auto kWrite>
absl::Status first_order(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  return kWrite(file, mesh.mesh, control);
}

/// Null where a format has more than one file.
FileWriter writer_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::kVtu:
      return write_vtu;
    case MeshFormat::kVtkHdf:
      return write_vtkhdf;
    case MeshFormat::kMsh:
      return write_msh;
    case MeshFormat::kInp:
      return write_inp;
    case MeshFormat::kStl:
      return first_order<write_stl>;
    case MeshFormat::kPly:
      return first_order<write_ply>;
    case MeshFormat::kObj:
      return first_order<write_obj>;
    case MeshFormat::kExodus:
      return write_exodus;
    case MeshFormat::kMfem:
      return first_order<write_mfem>;
    case MeshFormat::kUsd:
      return first_order<write_usd>;
    case MeshFormat::kXdmf:
    case MeshFormat::kPolyMesh:
      return nullptr;
  }
  return nullptr;
}

/// The .h5 beside an .xdmf, or the .hdf5 beside an index that is called otherwise: no two
/// meshes have one. Behind a symbolic link it is beside the file that this leads to. Errors:
/// kInvalidArgument (a name that no index can have).
absl::StatusOr<std::string> columns_path(const std::string& path) {
  fs::path columns = link_target(path);
  const std::string ending = absl::AsciiStrToLower(columns.extension().string());
  if (ending == ".h5" || ending == ".hdf5") {
    return absl::InvalidArgumentError(absl::StrCat(
        "the output ", path,
        " has the name of the file beside it: end it in .xdmf, and the .h5 comes too"));
  }
  // Only that ending gives way: `mesh`, `mesh.XDMF` and `mesh.0.04` have columns of their own.
  if (columns.extension() == ".xdmf") {
    columns.replace_extension(".h5");
  } else {
    columns += ".hdf5";
  }
  if (columns.filename().string().find(':') != std::string::npos) {
    return absl::InvalidArgumentError(
        absl::StrCat("the output ", path,
                     " has a colon in its name, behind which readers of .xdmf expect a "
                     "dataset: name it otherwise"));
  }
  return columns.string();
}

absl::Status write_two_files(const std::string& path,
                             const FileMesh& mesh,
                             const WriteControl& control) {
  const absl::StatusOr<std::string> columns_name = columns_path(path);
  if (!columns_name.ok()) return columns_name.status();
  absl::StatusOr<AtomicFile> index = AtomicFile::create(path);
  if (!index.ok()) return index.status();
  absl::StatusOr<AtomicFile> columns = AtomicFile::create(*columns_name);
  if (!columns.ok()) return columns.status();
  const std::string name = fs::path(*columns_name).filename().string();
  if (auto status = write_xdmf(*index, *columns, name, mesh, control); !status.ok()) {
    return status;
  }
  return commit_together(*columns, *index);
}

absl::Status write_folder(const std::string& path,
                          const TetMesh& mesh,
                          const WriteControl& control) {
  absl::StatusOr<AtomicFolder> folder = AtomicFolder::create(path, kPolyMeshFiles);
  if (!folder.ok()) return folder.status();
  if (auto status = write_polymesh(*folder, mesh, control); !status.ok()) return status;
  return folder->commit();
}

absl::Status write_one_file(FileWriter write,
                            const std::string& path,
                            const FileMesh& mesh,
                            const WriteControl& control) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = write(*file, mesh, control); !status.ok()) return status;
  return file->commit();
}

// ---- Names that change ----

/// What a format takes as names of regions, parts and faces, and of fields; unset where it
/// takes any.
struct FormatNames {
  std::optional<NameRule> groups = {}, fields = {};
};

FormatNames names_in(MeshFormat format) {
  switch (format) {
    case MeshFormat::kMsh:
      return {.groups = kMshNames};
    case MeshFormat::kInp:
      return {.groups = kInpNames};
    case MeshFormat::kExodus:
      return {.groups = kExodusNames, .fields = kExodusFieldNames};
    case MeshFormat::kPolyMesh:
      return {.groups = kFoamNames};
    case MeshFormat::kUsd:
      return {.groups = kUsdNames, .fields = kUsdNames};
    case MeshFormat::kPly:
      return {.fields = kPlyNames};
    case MeshFormat::kObj:
      return {.groups = kObjNames};
    default:
      return {};
  }
}

/// Those of the mesh, or those that are found where it has none. Which labels meet is known
/// by the tets alone.
std::vector<FaceLabel> face_labels_in(const MeshHeader& mesh) {
  if (mesh.has_faces() || !mesh.labels.empty()) return mesh.face_labels;
  const std::vector<FaceLabel> labels =
      face_labels_of(mesh.has_regions, mesh.has_regions || has_cut_faces(mesh));
  return mesh.parts.empty() ? labels : labels_of_parts(labels, mesh.parts);
}

void tell_changes(const std::vector<std::string>& names,
                  const std::vector<std::string>& changed,
                  std::string_view things,
                  std::vector<std::string>& told) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (changed[i] == names[i]) continue;
    told.push_back(absl::StrCat("the file calls the ", std::string(things), " \"", names[i],
                                "\" ", changed[i]));
  }
}

}  // namespace

absl::StatusOr<MeshOutput> mesh_output(const std::string& path, std::string_view format) {
  const auto chosen = format.empty() ? mesh_format_of(path) : mesh_format_named(format);
  if (!chosen.ok()) return chosen.status();
  return MeshOutput{path, *chosen};
}

absl::Status check_can_write(const MeshOutput& output) {
  if (output.format == MeshFormat::kVtkHdf || output.format == MeshFormat::kXdmf) {
    if (auto status = hdf5_part().status(); !status.ok()) return status;
  }
  if (output.format == MeshFormat::kXdmf) {
    const absl::StatusOr<std::string> columns = columns_path(output.path);
    if (!columns.ok()) return columns.status();
    if (auto status = check_can_create(*columns); !status.ok()) return status;
  }
  if (output.format == MeshFormat::kPolyMesh) {
    return check_can_create_folder(output.path, kPolyMeshFiles);
  }
  return check_can_create(output.path);
}

absl::StatusOr<std::vector<std::string>> files_of(const MeshOutput& output) {
  std::vector<std::string> files{output.path};
  if (output.format != MeshFormat::kXdmf) return files;
  absl::StatusOr<std::string> columns = columns_path(output.path);
  if (!columns.ok()) return columns.status();
  files.push_back(*std::move(columns));
  return files;
}

absl::Status check_takes_second_order(const MeshOutput& output) {
  if (!row_of(output.format).second_order.empty()) return absl::OkStatus();
  std::vector<std::string> endings;
  for (const MeshFormatRow& row : mesh_formats()) {
    if (!row.second_order.empty()) endings.emplace_back(row.ending);
  }
  return absl::InvalidArgumentError(absl::StrCat("a mesh of second order is written to ",
                                                 absl::StrJoin(endings, ", "), " files, and ",
                                                 output.path,
                                                 " is to be none: choose another ending or "
                                                 "--format, or --order 1"));
}

absl::Status write_mesh_file(const MeshOutput& output,
                             const FileMesh& mesh,
                             const WriteControl& control) {
  if (mesh.middles != nullptr) {
    if (auto status = check_takes_second_order(output); !status.ok()) return status;
  }
  if (output.format == MeshFormat::kXdmf) return write_two_files(output.path, mesh, control);
  if (output.format == MeshFormat::kPolyMesh)
    return write_folder(output.path, mesh.mesh, control);
  return write_one_file(writer_of(output.format), output.path, mesh, control);
}

absl::Status write_mesh_file(const std::string& path,
                             const TetMesh& mesh,
                             const WriteControl& control) {
  const absl::StatusOr<MeshOutput> output = mesh_output(path);
  return output.ok() ? write_mesh_file(*output, {mesh}, control) : output.status();
}

std::vector<std::string> changed_names(MeshFormat format, const MeshHeader& mesh) {
  const FormatNames rules = names_in(format);
  std::vector<std::string> told;
  const auto tell = [&](const std::vector<std::string>& names, std::string_view things) {
    if (rules.groups) tell_changes(names, names_in_file(names, *rules.groups), things, told);
  };
  if (format == MeshFormat::kVtkHdf) {  // which names parts, and neither labels nor faces
    tell_changes(names_of(mesh.parts), part_names_in_vtkhdf(mesh), "part", told);
  }
  tell(names_of(mesh.parts), "part");
  tell(distinct_names(mesh.labels), "label");
  tell(names_of(face_labels_in(mesh)), "faces");
  if (!rules.fields) return told;
  const std::vector<std::string> fields = names_of(mesh.fields);
  tell_changes(fields, array_names_in_file(fields, components_of(mesh.fields), *rules.fields),
               "field", told);
  return told;
}

}  // namespace tet
