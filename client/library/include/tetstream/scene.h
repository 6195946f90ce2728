// What is meshed, as a formula: primitives and volumes, put together.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tetstream/export.h"
#include "tetstream/status.h"
#include "tetstream/volume.h"

namespace tetstream {

/// A volume that a scene's text calls by this name.
struct SceneGrid {
  std::string name;
  Volume volume;
};

/// A solid as docs/scenes.md defines it, ready to be meshed any number of times. Copies share
/// it; it is never changed, so any thread may use it.
class TETSTREAM_API Scene {
 public:
  /// Reads the JSON that scene files have. A node `grid` names one of `grids`, or what a server
  /// stores (`grids/{sha256}`): a scene with one of those can be meshed there only. Errors:
  /// kInvalidArgument, which begins with the node that is wrong.
  static Result<Scene> from_json(const std::string& json,
                                 const std::vector<SceneGrid>& grids = {});

  struct Impl;
  explicit Scene(std::shared_ptr<const Impl> impl);
  const Impl& impl() const noexcept { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace tetstream
