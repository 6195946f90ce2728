// A solid meshed by CGAL's Mesh_3, as its manual does it, from a name to a file.
//   mesh3_solids ball|torus|gyroid|IMAGE.inr SIZE OUT.mesh
//   SIZE is the bound of a tet's circumradius; OUT is Medit's format. The solids are those of
//   solids.py.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

#include "bench/rivals/mesh3_types.h"

namespace tet::rivals {
namespace {

using Point = Kernel::Point_3;

double ball(const Point& p) { return std::hypot(p.x(), p.y(), p.z()) - 1; }

double torus(const Point& p) {
  constexpr double kRing = 0.75, kTube = 0.25;
  return std::hypot(std::hypot(p.x(), p.y()) - kRing, p.z()) - kTube;
}

double gyroid(const Point& p) {
  constexpr double kTurn = 2 * std::numbers::pi / 0.7;
  const double x = kTurn * p.x(), y = kTurn * p.y(), z = kTurn * p.z();
  const double value =
      std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
  return std::max(ball(p), value / (std::numbers::sqrt3 * kTurn));
}

Complex mesh_of(const std::string& solid, double size) {
  static const std::map<std::string, std::function<double(const Point&)>> functions = {
      {"ball", ball}, {"torus", torus}, {"gyroid", gyroid}};
  if (const auto found = functions.find(solid); found != functions.end()) {
    // The sphere around it, with some room, is given by the square of its radius.
    constexpr double kSquaredRadius = 1.21;
    const Domain domain = Domain::create_implicit_mesh_domain(
        found->second, Kernel::Sphere_3(CGAL::ORIGIN, kSquaredRadius));
    return CGAL::make_mesh_3<Complex>(domain, criteria_of_function(size));
  }
  CGAL::Image_3 image;
  if (!image.read(solid.c_str())) throw std::runtime_error("no image: " + solid);
  const Domain domain = Domain::create_labeled_image_mesh_domain(image);
  return CGAL::make_mesh_3<Complex>(domain, criteria_of_image(size));
}

}  // namespace
}  // namespace tet::rivals

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fputs("usage: mesh3_solids ball|torus|gyroid|IMAGE.inr SIZE OUT.mesh\n", stderr);
    return 2;
  }
  const auto mesh = tet::rivals::mesh_of(argv[1], std::stod(argv[2]));
  std::ofstream out(argv[3]);
  mesh.output_to_medit(out);
  return out.flush() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "mesh3_solids: %s\n", error.what());
  return 1;
}
