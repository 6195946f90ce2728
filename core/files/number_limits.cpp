#include "core/files/number_limits.h"

#include <absl/strings/str_cat.h>

namespace tet {

absl::Status check_count(std::uint64_t count,
                         std::uint64_t most,
                         std::string_view things,
                         std::string_view what) {
  if (count <= most) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "a ", std::string(what), " takes ", most, " ", std::string(things), " and the mesh has ",
      count, ": write a .vtkhdf or .vtu, or make the spacing larger"));
}

absl::Status check_numbers(const FileMesh& mesh, std::uint64_t most, std::string_view what) {
  const char* const nodes = mesh.middles == nullptr ? "vertices" : "nodes";
  if (auto status = check_count(mesh.shape().nodes, most, nodes, what); !status.ok()) {
    return status;
  }
  return check_count(mesh.mesh.header.tet_count, most, "tets", what);
}

}  // namespace tet
