#include "client/command/mesh/shape_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/second_order/measure_curved.h"

namespace tet {
namespace {

using Json = nlohmann::ordered_json;

Json place_json(const WorldPoint& p) { return {p.x, p.y, p.z}; }

Json ratio_json(const RatioStats& stats) {
  if (stats.count == 0) return nullptr;
  return {{"min", stats.min},
          {"mean", stats.mean()},
          {"max", stats.max},
          {"histogram", stats.histogram}};
}

Json worst_json(const WorstTet& worst) {
  return {{"tet", worst.tet},
          {"at", place_json(worst.at)},
          {"scaled_jacobian", worst.shape.scaled_jacobian},
          {"radius_ratio", worst.shape.radius_ratio},
          {"edge_ratio", worst.shape.edge_ratio}};
}

Json distance_json(const SurfaceDistance& distance, double spacing) {
  return {{"max", distance.max},
          {"rms", distance.rms},
          {"max_spacings", distance.max / spacing},
          {"rms_spacings", distance.rms / spacing},
          {"at", place_json(distance.at)},
          {"samples", distance.samples}};
}

}  // namespace

Json shapes_json(const ShapeStats& shapes) {
  Json worst = Json::array();
  for (const WorstTet& tet : shapes.worst) worst.push_back(worst_json(tet));
  return {{"not_positive", shapes.not_positive},
          {"scaled_jacobian", ratio_json(shapes.scaled_jacobian)},
          {"radius_ratio", ratio_json(shapes.radius_ratio)},
          {"edge_ratio", ratio_json(shapes.edge_ratio)},
          {"edge_lengths",
           {{"min", shapes.edges.min},
            {"max", shapes.edges.max},
            {"bins_per_octave", LengthStats::kBinsPerOctave},
            {"first_bin_spacings", std::exp2(LengthStats::kFirstOctave)},
            {"histogram", shapes.edges.histogram}}},
          {"worst", std::move(worst)}};
}

Json fidelity_json(const Fidelity& fidelity) {
  const double spacing = fidelity.spacing;
  Json json{{"mesh_to_surface", distance_json(fidelity.to_surface, spacing)},
            {"surface_to_mesh", distance_json(fidelity.from_surface, spacing)},
            {"hausdorff", fidelity.hausdorff()},
            {"hausdorff_spacings", fidelity.hausdorff() / spacing},
            {"mesh_area", fidelity.mesh_area},
            {"surface_area", fidelity.surface_area},
            {"mesh_volume", fidelity.mesh_volume}};
  if (!fidelity.enclosed_volume) return json;
  const double enclosed = *fidelity.enclosed_volume;
  json["enclosed_volume"] = enclosed;
  if (enclosed > 0) json["volume_error"] = (fidelity.mesh_volume - enclosed) / enclosed;
  return json;
}

Json second_order_json(const TetMesh& mesh, const MiddleNodes& middles) {
  const CurvedStats stats = measure_curved(mesh, middles);
  return {{"nodes", mesh.header.vertex_count + middles.count},
          {"curved", middles.curved},
          {"straightened", middles.straightened},
          {"volume", stats.volume},
          {"least_jacobian_share", stats.least_jacobian_share}};
}

}  // namespace tet
