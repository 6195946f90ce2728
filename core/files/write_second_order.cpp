#include "core/files/write_second_order.h"

#include <absl/strings/str_cat.h>

namespace tet {

WorldPoint SecondOrderMesh::node(std::uint64_t i) const noexcept {
  if (i < mesh.header.vertex_count) return mesh.vertex(i);
  const auto [x, y, z] = middles.stored_position(mesh.header, i - mesh.header.vertex_count);
  const WorldPoint& origin = mesh.header.origin;
  return {origin.x + x, origin.y + y, origin.z + z};
}

std::array<std::uint64_t, 10> SecondOrderMesh::nodes_of(std::uint64_t tet) const noexcept {
  const auto [a, b, c, d] = mesh.tet(tet);
  const auto middle = middles.of_tet(tet);
  const std::uint64_t first = mesh.header.vertex_count;
  return {a,
          b,
          c,
          d,
          first + middle[0],
          first + middle[1],
          first + middle[2],
          first + middle[3],
          first + middle[4],
          first + middle[5]};
}

absl::Status check_second_order_format(const MeshOutput& output) {
  const MeshFormat format = output.format;
  if (format == MeshFormat::kVtu || format == MeshFormat::kMsh) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--order 2 is written to .vtu and .msh files, and ", output.path,
                   " is neither: choose another ending, or --order 1"));
}

absl::Status write_second_order_file(const MeshOutput& output,
                                     const SecondOrderMesh& mesh,
                                     const WriteControl& control) {
  if (auto status = check_second_order_format(output); !status.ok()) return status;
  absl::StatusOr<AtomicFile> file = AtomicFile::create(output.path);
  if (!file.ok()) return file.status();
  const bool is_msh = output.format == MeshFormat::kMsh;
  const absl::Status written = is_msh ? write_second_order_msh(*file, mesh, control)
                                      : write_second_order_vtu(*file, mesh, control);
  if (!written.ok()) return written;
  return file->commit();
}

}  // namespace tet
