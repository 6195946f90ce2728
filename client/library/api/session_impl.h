// What a public session holds.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <absl/status/statusor.h>

#include "client/library/api/work.h"
#include "tetstream/mesh.h"
#include "tetstream/scene.h"
#include "tetstream/session.h"
#include "tetstream/volume.h"

namespace tetstream {

/// A frame's mesh, and how much of it is new.
struct FrameMesh {
  Mesh mesh;
  std::uint64_t tets_sent = 0;
};

/// Makes the mesh of each frame, after the first.
class FrameMaker {
 public:
  virtual ~FrameMaker() = default;
  virtual Result<FrameMesh> make(const Volume& before, const Volume& after) = 0;
  virtual Result<FrameMesh> make(const Scene& scene) = 0;
  /// A frame has failed, and nobody can make another.
  virtual bool is_over() const = 0;
  virtual Status end() = 0;
};

struct Session::Impl {
  explicit Impl(const WorkOptions& options) : work(options) {}

  Work work;  // first: the maker uses its cancellation
  std::unique_ptr<FrameMaker> maker;
  std::optional<Volume> volume;  ///< as it is now; nothing in the session of a scene
  std::optional<FrameMesh> now;
  bool over = false;
};

}  // namespace tetstream
