#include "tests/core/plan/cost_cases.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "core/scene/scene.h"
#include "core/volume/label_volume.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet::test {

namespace {

MeshRequest at_spacing(double spacing) {
  MeshRequest request;
  request.spacing = spacing;
  request.levels = 1;
  return request;
}

std::shared_ptr<const Volume> shared(Volume volume) {
  return std::make_shared<const Volume>(std::move(volume));
}

std::shared_ptr<const Scene> shared(Scene scene) {
  return std::make_shared<const Scene>(std::move(scene));
}

CostCase of_scene(std::string name, const SceneWriter& writer, double spacing) {
  return {std::move(name), shared(writer.scene()), at_spacing(spacing)};
}

/// Thousands of small solids of which a brick meets few, and all are looked at for each.
CostCase repeated_ellipsoids(double size) {
  SceneWriter writer;
  scene::Ellipsoid grain;
  grain.semi_axes = {1, 0.7, 0.5};
  scene::Repeat grains;
  grains.of = writer.add(grain);
  grains.count = {16, 16, size < 2 ? 2 : 8};
  grains.step = {1.9, 1.3, 0.9};
  writer.add(grains);
  return of_scene("repeated ellipsoids", writer, 1 / size);
}

/// Solids that all matter wherever one does: nothing can be left out.
CostCase blended_spheres(double size) {
  SceneWriter writer;
  scene::Combination all;
  all.smoothing = 1;
  for (int i = 0; i < 100; ++i) {
    const std::string sphere = writer.add(scene::Sphere{1});
    all.of.push_back(writer.add_moved({0.001 * i, 0, 0}, sphere));
  }
  writer.add(all);
  return of_scene("100 blended spheres", writer, 0.05 / size);
}

CostCase tiny_spacing(double size) {
  SceneWriter writer;
  writer.add(scene::Sphere{1});
  return of_scene("a sphere at a small spacing", writer, 0.012 / size);
}

CostCase sheets(double size) {
  SceneWriter writer;
  scene::Combination cut;
  cut.how = scene::Combine::kIntersection;
  cut.of.push_back(writer.add(scene::Sphere{1}));
  scene::PeriodicSurface gyroid;
  gyroid.period = 0.25;
  gyroid.thickness = 0.05;
  cut.of.push_back(writer.add(gyroid));
  writer.add(cut);
  return of_scene("a gyroid in a sphere", writer, 0.02 / size);
}

/// Any value at any voxel: there is surface in every cell, also of a finer lattice.
CostCase noise(double size, double part_of_voxel) {
  const int edge =
      static_cast<int>(std::lround((part_of_voxel < 1 ? 16 : 40) * std::pow(size, 2.0 / 3)));
  return {"random signs at " + std::to_string(part_of_voxel).substr(0, 4) + " of a voxel",
          shared(random_signs(edge, 1)), at_spacing(part_of_voxel)};
}

CostCase parts_of_a_voxel(double size) {
  return {"a small ball at a small part of its voxels", shared(ball(8)),
          at_spacing(0.25 / size)};
}

/// Cubes of 4096 voxels, of which the file has a few bytes each, at a spacing of 255 voxels.
CostCase huge_tiles(double size) {
  Volume volume;
  volume.background = 1;
  const auto count = static_cast<std::int32_t>(std::lround(2 * std::pow(size, 2.0 / 3)));
  for (std::int32_t x = 0; x < count; ++x) {
    for (std::int32_t y = 0; y < count; ++y) {
      volume.cubes.push_back(
          {{2 * kLargestCube * x, 2 * kLargestCube * y, 0}, kLargestCube, -1});
    }
  }
  return {"huge tiles at 255 voxels", shared(std::move(volume)), at_spacing(255)};
}

/// A label for each block of voxels, from a hash.
CostCase many_labels(double size) {
  const auto edge = static_cast<std::int32_t>(std::lround(16 * std::pow(size, 2.0 / 3)));
  std::vector<std::int64_t> labels;
  for (std::int32_t z = 0; z < edge; ++z) {
    for (std::int32_t y = 0; y < edge; ++y) {
      for (std::int32_t x = 0; x < edge; ++x) {
        const std::uint32_t block =
            static_cast<std::uint32_t>(x / 2 + 97 * (y / 2) + 9973 * (z / 2));
        labels.push_back(1 + (block * 2654435761U >> 16) % 1000);
      }
    }
  }
  LabelImage image;
  image.size = {edge, edge, edge};
  image.values = labels;
  MeshRequest request = at_spacing(1);
  request.labels.emplace();
  return {"a thousand labels, two voxels each",
          std::make_shared<const LabelVolume>(*make_label_volume(image)), request};
}

CostCase with(CostCase plain, const char* name, MeshRequest request) {
  request.spacing = plain.request.spacing;
  return {name, std::move(plain.shape), std::move(request)};
}

std::vector<CostCase> asked_for_more(double size) {
  const auto solid = [size](double radius) { return plain_ball(radius * size); };
  MeshRequest improved = at_spacing(1), uniform = improved, manifold = improved,
              both = improved, creased = improved, sized = improved, graded = improved,
              faced = improved;
  improved.improve = true;
  uniform.levels = 0;
  manifold.manifold = true;
  both.preset = Preset::kBothSides;
  faced.faces = true;
  creased.faces = true;
  FaceRegion side;
  side.name = "side";
  side.creases = FaceRegion::Creases{40};
  creased.face_regions.push_back(side);
  graded.sizing.grade_surface = true;
  graded.sizing.coarsest = 4;
  graded.levels = 2;
  sized.levels = kMaxLevels;
  sized.sizing.growth = Sizing::kMinGrowth;
  std::vector<CostCase> cases;
  cases.push_back(with(solid(10), "improved", improved));
  cases.push_back(with(solid(30), "uniform", uniform));
  cases.push_back(with(solid(30), "manifold", manifold));
  cases.push_back(with(solid(20), "both sides", both));
  cases.push_back(with(solid(30), "with faces", faced));
  cases.push_back(with(solid(20), "divided at creases", creased));
  cases.push_back(with(solid(30), "sizes that grow slowly", sized));
  cases.push_back(with(solid(20), "a graded surface", graded));
  return cases;
}

CostCase several(double size) {
  const auto one = plain_ball(20 * size);
  GridList grids;
  for (const char* name : {"a", "b", "c"}) {
    Volume volume = *volume_of(one.shape);
    volume.name = name;
    grids.push_back(shared(std::move(volume)));
  }
  return {"three grids", std::move(grids), at_spacing(1)};
}

}  // namespace

CostCase plain_ball(double radius) { return {"a ball", shared(ball(radius)), at_spacing(1)}; }

std::vector<CostCase> cost_cases(double size) {
  std::vector<CostCase> cases{repeated_ellipsoids(size),
                              blended_spheres(size),
                              tiny_spacing(size),
                              sheets(size),
                              noise(size, 1),
                              noise(size, 0.3),
                              parts_of_a_voxel(size),
                              huge_tiles(size),
                              many_labels(size),
                              several(size)};
  for (CostCase& more : asked_for_more(size)) cases.push_back(std::move(more));
  return cases;
}

}  // namespace tet::test
