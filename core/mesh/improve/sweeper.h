// Sweeps over the vertices of a mesh, one independent set of them after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/parallel.h"
#include "core/mesh/improve/vertex_stars.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Moves chosen vertices. `make_mover()` makes what moves those of a task, and a mover's
/// `move(vertex, star, home)` says where one goes, as `place`, and whether nothing better is
/// wanted of it, as `good`. The vertices of a set move at the same time and read nothing that
/// moves meanwhile, so any number of threads finds the same places.
template <class MakeMover>
class Sweeper {
 public:
  Sweeper(TetMesh& mesh, VertexStars stars, MakeMover make_mover)
      : mesh_(mesh),
        make_mover_(std::move(make_mover)),
        stars_(std::move(stars)),
        sets_(independent_sets(mesh, stars_)),
        states_(stars_.size()) {
    for (std::size_t i = 0; i < stars_.size(); ++i) {
      states_[i].home = mesh.stored_position(stars_.vertex(i));
    }
  }

  /// Once cancelled, some of it.
  void sweep(const Cancellation& cancellation) {
    for (const std::vector<std::uint32_t>& set : sets_) {
      for_each_range(set.size(), kStarsPerRange, [&](std::size_t begin, std::size_t end) {
        if (cancellation.requested()) return;
        auto mover = make_mover_();
        for (std::size_t i = begin; i < end; ++i) move(set[i], mover);
      });
    }
    for (std::uint32_t i = 0; i < stars_.size(); ++i) {
      if (states_[i].reopens) reopen_around(i);
    }
  }

  /// Calls `visit(vertex)` for each, ascending, of which a better place is wanted still.
  template <class Visit>
  void for_each_open(const Visit& visit) const {
    for (std::size_t i = 0; i < stars_.size(); ++i) {
      if (!states_[i].good) visit(stars_.vertex(i));
    }
  }

  std::uint64_t moved_vertices() const {
    return static_cast<std::uint64_t>(std::count_if(
        states_.begin(), states_.end(), [](const VertexState& state) { return state.moved; }));
  }

 private:
  static constexpr std::size_t kStarsPerRange = 32;

  /// What is remembered of a vertex from sweep to sweep.
  struct VertexState {
    WorldPoint home;  ///< before the first move
    bool good = false;
    bool moved = false;
    bool reopens = false;  ///< moved in this sweep, but its star is not good yet
  };

  template <class Mover>
  void move(std::uint32_t i, Mover& mover) {
    VertexState& state = states_[i];
    if (state.good) return;
    const std::uint64_t vertex = stars_.vertex(i);
    const auto outcome = mover.move(vertex, stars_.star(i), state.home);
    state.good = outcome.good;
    if (!outcome.place) return;
    mesh_.store_position(vertex, *outcome.place);
    state.moved = true;
    state.reopens = !outcome.good;
  }

  /// A move that helps a bad star may cost its good tets so much that they are not good any
  /// more.
  void reopen_around(std::uint32_t i) {
    states_[i].reopens = false;
    for (const TetCorner corner : stars_.star(i)) {
      for (const std::uint64_t vertex : mesh_.tet(corner.tet())) {
        const std::uint32_t other = stars_.number(vertex);
        if (other != VertexStars::kNotChosen) states_[other].good = false;
      }
    }
  }

  TetMesh& mesh_;
  const MakeMover make_mover_;
  const VertexStars stars_;
  const std::vector<std::vector<std::uint32_t>> sets_;
  std::vector<VertexState> states_;
};

}  // namespace tet
