// OpenVDB's own surface mesher, to hold ours against.
#pragma once

#include <cstdint>
#include <memory>

#include "core/volume/volume.h"

namespace tet::bench {

/// A volume as an OpenVDB grid, whose surface `openvdb::tools::volumeToMesh` makes.
class OpenVdbSurface {
 public:
  /// `volume` is a level set: what lies nearer to the surface than its background is active.
  explicit OpenVdbSurface(const Volume& volume);
  ~OpenVdbSurface();

  /// Makes the surface at 0, as fine as the grid, and gives it back; returns its triangles, two
  /// a quad. Parallel: run it on a TaskPool.
  std::uint64_t count_triangles() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tet::bench
