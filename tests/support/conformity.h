// Is this a mesh? Everything a conforming, positive mesh must satisfy, counted. For tests and
// dev.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// How often a rule was broken, and where first.
struct Offences {
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t count = 0;
  std::uint64_t first = kNone;  ///< smallest id among the offenders

  void add(std::uint64_t id) noexcept {
    ++count;
    if (id < first) first = id;
  }
  void add(const Offences& other) noexcept {
    count += other.count;
    if (other.first < first) first = other.first;
  }
};

/// What `check_conformity` found. Ids that do not exist or repeat within a tet hide the rest:
/// the other rules are then not looked at.
struct ConformityReport {
  Offences bad_ids;            ///< tets with an id out of range, or the same one twice
  Offences non_positive_tets;  ///< tets with det(b-a, c-a, d-a) <= 0
  Offences crowded_faces;      ///< tets with a face that three or more share
  Offences folded_faces;       ///< tets with a face whose other tet lies on the same side
  Offences unreferenced_vertices;
  Offences duplicate_vertices;  ///< vertices at the position of a vertex with a smaller id

  std::uint64_t inner_faces = 0;     ///< shared by exactly two tets of opposite orientation
  std::uint64_t boundary_faces = 0;  ///< of one tet only

  bool conforming() const noexcept;
  /// The broken rules in words, for a test's message; empty when conforming.
  std::string describe() const;
};

/// Checks the whole mesh, in parallel. Needs about 50 bytes a tet.
ConformityReport check_conformity(const TetMesh& mesh);

}  // namespace tet
