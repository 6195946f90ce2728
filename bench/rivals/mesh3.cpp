#include "bench/rivals/mesh3.h"

#include <algorithm>
#include <cstddef>
#include <unordered_map>

#include "bench/peak_memory.h"
#include "bench/rivals/mesh3_types.h"

namespace tet::rivals {
namespace {

/// An image of bytes, which CGAL's image owns.
CGAL::Image_3 image_of(const LabelCube& cube) {
  const auto edge = static_cast<std::size_t>(cube.edge);
  _image* const image = _createImage(edge, edge, edge, 1, 1, 1, 1, 1, WK_FIXED, SGN_UNSIGNED);
  std::ranges::copy(cube.label, static_cast<std::uint8_t*>(image->data));
  return CGAL::Image_3(image);
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
  const Criteria criteria = criteria_of_image(request.cell_size);
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
