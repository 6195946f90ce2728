#include "core/mesh/improve/sweeper.h"

#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

/// What movers do where there is no memory for the tets around a vertex.
struct MoverWithoutMemory {
  struct Outcome {
    std::optional<WorldPoint> place;
    bool good = false;
  };
  Outcome move(std::uint64_t, std::span<const TetCorner>, const WorldPoint&) {
    throw std::bad_alloc();
  }
};

TEST(Sweeper, PassesOnThatThereIsNoMemory) {
  TetMesh mesh = kuhn_mesh(2);
  Sweeper sweeper(mesh, VertexStars(mesh, std::vector<std::uint64_t>{0}),
                  [] { return MoverWithoutMemory(); });
  EXPECT_THROW(sweeper.sweep({}), std::bad_alloc);
}

}  // namespace
}  // namespace tet
