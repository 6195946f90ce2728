// A mesh with boundary faces as whoever takes chunks in any order puts it together.
#pragma once

#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"

namespace tet::test {

/// The mesh of a plan, chunk by chunk and the last one first.
inline TetMesh mesh_by_chunks(const Shape& shape,
                              const MeshRequest& request,
                              std::size_t chunk_bytes = kChunkBytes) {
  TaskPool pool(2);
  TetMesh joined;
  pool.run([&] {
    const auto plan =
        plan_mesh({.shape = shape, .request = request, .limits = {.chunk_bytes = chunk_bytes}});
    ASSERT_TRUE(plan.ok()) << plan.status();
    joined = TetMesh((*plan)->header());
    MeshWorkspace workspace;
    std::uint64_t faces = (*plan)->header().face_count;
    for (std::uint64_t i = (*plan)->header().chunk_count; i-- > 0;) {
      const ChunkExtent chunk = (*plan)->chunk(i);
      EXPECT_EQ(chunk.first_face + chunk.face_count, faces) << "chunk " << i;
      faces = chunk.first_face;
      (*plan)->fill_chunk(i, workspace, joined.columns_of(chunk));
    }
    EXPECT_EQ(faces, 0U);
  });
  return joined;
}

}  // namespace tet::test
