#include "tetstream/mesh_file.h"

#include "client/library/api/mesh_impl.h"
#include "client/library/api/work.h"
#include "core/files/mesh_file.h"

namespace tetstream {

Status write_mesh_file(const std::string& path, const Mesh& mesh, const WorkOptions& options) {
  return write_mesh_file(path, mesh, std::string(), options);
}

Status write_mesh_file(const std::string& path,
                       const Mesh& mesh,
                       const std::string& format,
                       const WorkOptions& options) {
  return guarded([&]() -> Status {
    const Work work(options);
    const auto output = tet::mesh_output(path, format);
    if (!output.ok()) return to_public(output.status());
    return to_public(tet::write_mesh_file(
        *output, {mesh.impl().mesh},
        {.cancellation = &work.cancellation(), .progress = options.progress}));
  });
}

}  // namespace tetstream
