#include "bench/rivals/contender.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <set>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/tet_geometry.h"

namespace tet::rivals {
namespace {

void add_angles(const PlainMesh& mesh, const std::array<std::uint32_t, 4>& tet, Result& out) {
  std::array<WorldPoint, 4> at;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [x, y, z] = mesh.vertex[tet[i]];
    at[i] = {x, y, z};
  }
  const auto normal = face_normals(at[0], at[1], at[2], at[3]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = -dot(normal[i], normal[j]) /
                            std::sqrt(dot(normal[i], normal[i]) * dot(normal[j], normal[j]));
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
      out.min_deg = std::min(out.min_deg, angle);
      out.max_deg = std::max(out.max_deg, angle);
    }
  }
}

Result result_of(const PlainMesh& mesh) {
  Result result;
  result.tets = mesh.tet.size();
  result.labels =
      static_cast<int>(std::set<std::uint8_t>(mesh.label.begin(), mesh.label.end()).size());
  result.cpu_seconds = mesh.cpu_seconds;
  result.peak_bytes = mesh.peak_bytes;
  for (const auto& tet : mesh.tet) add_angles(mesh, tet, result);
  return result;
}

[[noreturn]] void give_up(const char* what) {
  std::perror(what);
  std::exit(1);
}

}  // namespace

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Result measure(const std::function<PlainMesh()>& make) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) give_up("pipe");
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) give_up("fork");
  Result result;
  if (child == 0) {
    result = result_of(make());
    const bool told = write(ends[1], &result, sizeof(result)) == sizeof(result);
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  const bool told = read(ends[0], &result, sizeof(result)) == sizeof(result);
  close(ends[0]);
  int status = 0;
  if (waitpid(child, &status, 0) != child || status != 0 || !told) {
    std::fprintf(stderr, "a contender failed: status %d\n", status);
    std::exit(1);
  }
  return result;
}

}  // namespace tet::rivals
