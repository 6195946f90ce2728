#include "server/workspace_pool.h"

#include <utility>

namespace tet {

MeshWorkspace WorkspacePool::take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      MeshWorkspace workspace = std::move(idle_.back());
      idle_.pop_back();
      return workspace;
    }
  }
  return {};
}

void WorkspacePool::give_back(MeshWorkspace workspace) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(workspace));
}

}  // namespace tet
