// What a public mesh holds.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "client/library/api/to_public.h"
#include "client/library/chunk_supply.h"
#include "core/mesh/face_counts.h"
#include "core/mesh/tet_mesh.h"
#include "tetstream/mesh.h"

namespace tetstream {

struct Mesh::Impl {
  Impl(tet::TetMesh made, const tet::TrailerFacts& facts, std::string id)
      : mesh(std::move(made)),
        header(to_public(mesh.header, std::move(id))),
        columns(columns_of(mesh)),
        statistics(statistics_of(mesh, facts)) {}

  static Statistics statistics_of(const tet::TetMesh& mesh, const tet::TrailerFacts& facts) {
    Statistics told = to_public(facts);
    told.empty_face_regions = tet::empty_face_regions(mesh.header, tet::count_faces(mesh));
    return told;
  }

  const tet::TetMesh mesh;
  const MeshHeader header;
  const MeshColumns columns;
  const Statistics statistics;
};

inline Mesh public_mesh(tet::TetMesh made,
                        const tet::TrailerFacts& facts,
                        std::string id = {}) {
  return Mesh(std::make_shared<const Mesh::Impl>(std::move(made), facts, std::move(id)));
}

}  // namespace tetstream
