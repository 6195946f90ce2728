// CGAL's Mesh_3 for functions and images, and how large it makes what it makes.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Image_3.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

namespace tet::rivals {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

/// The criteria of the manual's example for a function, larger or smaller as a whole: `size`
/// bounds a tet's circumradius.
inline Criteria criteria_of_function(double size) {
  namespace p = CGAL::parameters;
  return Criteria(p::facet_angle = 30, p::facet_size = size, p::facet_distance = size / 4,
                  p::cell_radius_edge_ratio = 2, p::cell_size = size);
}

/// The criteria of its example for an image, in the same way.
inline Criteria criteria_of_image(double size) {
  namespace p = CGAL::parameters;
  constexpr double kFacetSize = 6.0 / 8, kFacetDistance = 4.0 / 8;
  return Criteria(p::facet_angle = 30, p::facet_size = kFacetSize * size,
                  p::facet_distance = kFacetDistance * size, p::cell_radius_edge_ratio = 3,
                  p::cell_size = size);
}

}  // namespace tet::rivals
