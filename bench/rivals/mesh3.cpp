#include "bench/rivals/mesh3.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Image_3.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <algorithm>
#include <cstddef>
#include <unordered_map>

#include "bench/peak_memory.h"

namespace tet::rivals {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

/// An image of bytes, which CGAL's image owns.
CGAL::Image_3 image_of(const LabelCube& cube) {
  const auto edge = static_cast<std::size_t>(cube.edge);
  _image* const image = _createImage(edge, edge, edge, 1, 1, 1, 1, 1, WK_FIXED, SGN_UNSIGNED);
  std::ranges::copy(cube.label, static_cast<std::uint8_t*>(image->data));
  return CGAL::Image_3(image);
}

/// The criteria of the manual's example, larger or smaller as a whole.
Criteria criteria_of(double cell_size) {
  constexpr double kFacetSize = 6.0 / 8, kFacetDistance = 4.0 / 8;
  namespace p = CGAL::parameters;
  return Criteria(p::facet_angle = 30, p::facet_size = kFacetSize * cell_size,
                  p::facet_distance = kFacetDistance * cell_size, p::cell_radius_edge_ratio = 3,
                  p::cell_size = cell_size);
}

PlainMesh plain(const Complex& complex) {
  PlainMesh mesh;
  std::unordered_map<Triangulation::Vertex_handle, std::uint32_t> id_of;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end();
       ++cell) {
    std::array<std::uint32_t, 4> tet{};
    for (int i = 0; i < 4; ++i) {
      const auto vertex = cell->vertex(i);
      const auto [known, is_new] =
          id_of.try_emplace(vertex, static_cast<std::uint32_t>(mesh.vertex.size()));
      if (is_new) {
        const auto& at = vertex->point();
        mesh.vertex.push_back({at.x(), at.y(), at.z()});
      }
      tet[static_cast<std::size_t>(i)] = known->second;
    }
    mesh.tet.push_back(tet);
    mesh.label.push_back(static_cast<std::uint8_t>(complex.subdomain_index(cell)));
  }
  return mesh;
}

}  // namespace

PlainMesh mesh_with_mesh3(const LabelCube& cube, const Mesh3Request& request) {
  namespace p = CGAL::parameters;
  const bench::PeakMemory peak;
  const double start = cpu_seconds();
  const CGAL::Image_3 image = image_of(cube);
  const Domain domain = Domain::create_labeled_image_mesh_domain(image);
  const Criteria criteria = criteria_of(request.cell_size);
  const Complex complex =
      request.optimized
          ? CGAL::make_mesh_3<Complex>(domain, criteria)
          : CGAL::make_mesh_3<Complex>(domain, criteria, p::no_perturb(), p::no_exude());
  const double seconds = cpu_seconds() - start;
  const double bytes = peak.peak_bytes();
  PlainMesh mesh = plain(complex);
  mesh.cpu_seconds = seconds;
  mesh.peak_bytes = bytes;
  return mesh;
}

}  // namespace tet::rivals
