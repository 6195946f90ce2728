// Memory for one chunk after another, of which a reader may keep some.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Has the columns of one chunk at a time. Memory is used again unless somebody keeps it: then
/// the next chunk gets other memory. A few take turns, for readers who let go of a chunk when
/// some others have come.
class ReusedChunk {
 public:
  /// Makes columns for a mesh of `header`, which are not filled.
  TetMesh& make(const MeshHeader& header) {
    turn_ = first_free();
    std::shared_ptr<TetMesh>& mesh = turns_[turn_];
    if (mesh == nullptr || is_kept(mesh)) {
      mesh = std::make_shared<TetMesh>(header);
    } else {
      *mesh = TetMesh(header, std::move(*mesh));
    }
    return *mesh;
  }

  /// The columns made last; `make` was called before.
  TetMesh& mesh() const noexcept { return *turns_[turn_]; }
  /// Keeps them: they stay as they are while the result, or a copy of it, lives.
  std::shared_ptr<const TetMesh> kept() const noexcept { return turns_[turn_]; }

 private:
  static constexpr std::size_t kTurns = 6;

  static bool is_kept(const std::shared_ptr<TetMesh>& mesh) noexcept {
    if (mesh.use_count() > 1) return true;
    // Another thread may have been the last to read it: it did so before what follows.
    std::atomic_thread_fence(std::memory_order_acquire);
    return false;
  }

  /// Where all are kept, it is the turn of the one after the last, whose readers keep it alone.
  std::size_t first_free() const noexcept {
    for (std::size_t i = 0; i < kTurns; ++i) {
      if (turns_[i] == nullptr || !is_kept(turns_[i])) return i;
    }
    return (turn_ + 1) % kTurns;
  }

  std::array<std::shared_ptr<TetMesh>, kTurns> turns_;
  std::size_t turn_ = 0;
};

}  // namespace tet
