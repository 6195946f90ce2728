// Scratch memory for making chunks.
#pragma once

#include <mutex>
#include <vector>

#include "core/pipeline/mesh_plan.h"

namespace tet {

/// Scratch memory that tasks take turns with. Thread-safe.
class WorkspacePool {
 public:
  MeshWorkspace take();
  void give_back(MeshWorkspace workspace);

 private:
  std::mutex mutex_;
  std::vector<MeshWorkspace> idle_;
};

}  // namespace tet
