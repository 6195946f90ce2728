// A ball that moves out of another one, followed under ids that do not move: of each frame only
// what changed is read.
//   follow_shape [HOST:PORT]
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <tetstream/tetstream.h>
#include <vector>

tetstream::Scene shape(int step) {
  return tetstream::Scene::from_json(R"({"nodes": [
    {"name": "still", "sphere": {"radius": 1}},
    {"name": "small", "sphere": {"radius": 0.3}},
    {"name": "moving", "transform": {"of": "small", "translation": [)" +
                                     std::to_string(0.9 + 0.01 * step) + R"(, 0, 0]}},
    {"union": {"of": ["still", "moving"]}}]})")
      .value();
}

int main(int argc, char** argv) try {
  const tetstream::Request request{.spacing = 0.05};
  tetstream::StableSession session =
      argc > 1 ? tetstream::Client::connect(argv[1])
                     .value()
                     .begin_stable_session(shape(0), request)
                     .value()
               : tetstream::begin_stable_session(shape(0), request).value();

  std::vector<std::uint32_t> corners;  // of all slots, as a renderer has them in its own buffer
  for (int step = 0; step <= 4; ++step) {
    if (step > 0) session.update(shape(step)).or_throw();
    const tetstream::StableMesh& mesh = session.mesh();
    corners.resize(mesh.columns.tets32.size());
    std::size_t changed = 0;
    for (const tetstream::SlotRange& range : mesh.changed_tets) {
      std::copy_n(mesh.columns.tets32.begin() + 4 * range.begin, 4 * (range.end - range.begin),
                  corners.begin() + 4 * range.begin);
      changed += range.end - range.begin;
    }
    std::printf("%zu tets, %zu slots changed%s\n",
                static_cast<std::size_t>(mesh.header.tet_count), changed,
                mesh.renumbered ? ", all of them" : "");
  }
  const tetstream::Mesh whole = session.in_order().value();
  tetstream::write_mesh_file("followed.vtu", whole).or_throw();
  session.end().or_throw();
  return 0;
} catch (const tetstream::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
