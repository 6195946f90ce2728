// A segmentation from an array: one mesh of its tissues, which share their interfaces.
//   mesh_labels
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>
#include <tetstream/tetstream.h>
#include <vector>

int main() try {
  constexpr int kEdge = 24;
  std::vector<std::uint8_t> values;  // marrow (7) within bone (4), by voxels of 0.5 x 0.5 x 1.5
  for (int x = 0; x < kEdge; ++x)
    for (int y = 0; y < kEdge; ++y)
      for (int z = 0; z < kEdge; ++z) {
        const double r = std::hypot(x - 11.5, y - 11.5, z - 11.5);
        values.push_back(r > 10 ? 0 : r > 5 ? 4 : 7);
      }
  const tetstream::LabelArray voxels{.values = std::span<const std::uint8_t>(values),
                                     .size = {kEdge, kEdge, kEdge},
                                     .steps = {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1.5}}}};

  const tetstream::Labels labels = tetstream::Labels::from_voxels(voxels).value();
  tetstream::Request request{.faces = true};
  request.labels = {.only = {{4, 7}}, .names = {{4, "bone"}}};
  const tetstream::Mesh tissues = tetstream::mesh(labels, request).value();

  std::vector<std::size_t> tets(tissues.header().labels.size());
  for (const std::uint16_t label : tissues.columns().labels) ++tets[label];
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const tetstream::MeshLabel& label = tissues.header().labels[i];
    std::printf("%lld %s: %zu tets\n", static_cast<long long>(label.value), label.name.c_str(),
                tets[i]);
  }
  tetstream::write_mesh_file("tissues.vtu", tissues).or_throw();
  return 0;
} catch (const tetstream::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
