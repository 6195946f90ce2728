#include "core/files/mesh_file.h"

#include <filesystem>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "core/files/write_msh.h"
#include "core/files/write_vtkhdf.h"
#include "core/files/write_vtu.h"

namespace tet {
namespace {

absl::Status write_as(MeshFormat format,
                      AtomicFile& file,
                      const TetMesh& mesh,
                      const WriteControl& control) {
  switch (format) {
    case MeshFormat::kVtu:
      return write_vtu(file, mesh, control);
    case MeshFormat::kMsh:
      return write_msh(file, mesh, control);
    case MeshFormat::kVtkHdf:
      return write_vtkhdf(file, mesh, control);
  }
  return absl::InternalError("no such mesh format");
}

}  // namespace

absl::StatusOr<MeshFormat> mesh_format_of(const std::string& path) {
  const std::string ending =
      absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (ending == ".vtu") return MeshFormat::kVtu;
  if (ending == ".msh") return MeshFormat::kMsh;
  if (ending == ".vtkhdf") return MeshFormat::kVtkHdf;
  return absl::InvalidArgumentError(
      absl::StrCat("the output ", path, " ends in ", ending.empty() ? "nothing" : ending,
                   "; it must end in .vtu, .msh or .vtkhdf, which chooses the format"));
}

absl::Status write_mesh_file(const std::string& path,
                             const TetMesh& mesh,
                             const WriteControl& control) {
  const absl::StatusOr<MeshFormat> format = mesh_format_of(path);
  if (!format.ok()) return format.status();
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = write_as(*format, *file, mesh, control); !status.ok())
    return status;
  return file->commit();
}

}  // namespace tet
