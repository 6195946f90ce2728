// A ball from an array: meshed in this process, and by a server where one is named.
//   first_mesh [HOST:PORT]
#include <cmath>
#include <cstdio>
#include <tetstream/tetstream.h>
#include <vector>

int main(int argc, char** argv) try {
  constexpr int kEdge = 41;
  std::vector<float> distances;  // to a sphere of radius 1, at points 0.06 apart
  for (int x = 0; x < kEdge; ++x)
    for (int y = 0; y < kEdge; ++y)
      for (int z = 0; z < kEdge; ++z)
        distances.push_back(0.06F * std::hypot(x - 20.F, y - 20.F, z - 20.F) - 1);
  const tetstream::Volume ball = tetstream::Volume::from_samples({.values = distances,
                                                                  .size = {kEdge, kEdge, kEdge},
                                                                  .spacing = 0.06,
                                                                  .origin = {-1.2, -1.2, -1.2}})
                                     .value();

  const tetstream::Mesh here = tetstream::mesh(ball).value();
  std::printf("%zu tets, volume %.3f\n", here.tet_count(), here.statistics().quality->volume);
  tetstream::write_mesh_file("ball.vtu", here).or_throw();

  if (argc < 2) return 0;
  const tetstream::Client client = tetstream::Client::connect(argv[1]).value();
  const tetstream::Mesh there = client.mesh(client.upload(ball).value()).value();
  std::printf("%zu tets from %s\n", there.tet_count(), argv[1]);
  return there.tet_count() == here.tet_count() ? 0 : 1;
} catch (const tetstream::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
