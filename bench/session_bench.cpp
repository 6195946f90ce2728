// Frames a second of sessions: a mesh that follows its shape, over loopback, into the client's
// arrays.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/checked.h"
#include "bench/loopback.h"
#include "client/library/remesh_session.h"
#include "core/vdb/openvdb/load.h"
#include "server/ops/logging.h"

namespace tet::bench {
namespace {

void add_number(v1::Transform& transform, double x, double y, double z) {
  for (const double along : {x, y, z}) transform.add_translation(along);
}

/// A ball of radius 1, and a smaller one that goes around it at `turn`.
v1::Scene moon(double turn) {
  v1::Scene scene;
  v1::SceneNode& planet = *scene.add_nodes();
  planet.set_name("planet");
  planet.mutable_sphere()->set_radius(1);
  v1::SceneNode& small = *scene.add_nodes();
  small.set_name("small");
  small.mutable_sphere()->set_radius(0.15);
  v1::SceneNode& moon = *scene.add_nodes();
  moon.set_name("moon");
  moon.mutable_transform()->set_of("small");
  add_number(*moon.mutable_transform(), 1.3 * std::cos(turn), 1.3 * std::sin(turn), 0);
  v1::SceneNode& both = *scene.add_nodes();
  for (const char* of : {"planet", "moon"}) both.mutable_union_()->add_of(of);
  return scene;
}

/// The whole scene moves: nothing stays where it was.
v1::Scene sliding(double turn) {
  v1::Scene scene;
  v1::SceneNode& ball = *scene.add_nodes();
  ball.set_name("ball");
  ball.mutable_sphere()->set_radius(1);
  v1::SceneNode& moved = *scene.add_nodes();
  moved.mutable_transform()->set_of("ball");
  add_number(*moved.mutable_transform(), 0.1 * std::sin(turn), 0, 0);
  return scene;
}

using MakeScene = v1::Scene (*)(double turn);

/// Frame after frame, each brought about by `change`.
template <class Change>
void follow(benchmark::State& state, RemeshSession& session, const Change& change) {
  double frame = 0, sent = 0, tets = 0;
  for (auto _ : state) {
    if (!change(++frame).ok()) state.SkipWithError("the session ended");
    sent += static_cast<double>(session.tets_sent());
    tets += static_cast<double>(session.mesh().mesh.header.tet_count);
  }
  state.counters["tets"] = tets / frame;
  state.counters["sent"] = sent / tets;
  state.counters["frames/s"] = benchmark::Counter(frame, benchmark::Counter::kIsRate);
}

/// `levels` 0 for uniform meshes. A frame moves the scene by a hundredth of a turn.
void follow_scene(benchmark::State& state,
                  MakeScene make,
                  double spacing,
                  int levels,
                  bool statistics = true,
                  Transport transport = Transport::kPort) {
  Loopback loopback(transport);
  v1::MeshRequest request;
  *request.mutable_scene() = make(0);
  request.set_spacing(spacing);
  request.set_levels(levels);
  request.set_skip_statistics(!statistics);
  const Cancellation never;
  const auto session = checked(loopback.client().begin_session(request, never));
  follow(state, *session, [&](double frame) { return session->update(make(0.0628 * frame)); });
}

/// One in `share` of the leaves of a volume, their surface moved out and in.
std::vector<v1::LeafUpdate> breathing(const Volume& volume, double frame, std::size_t share) {
  std::vector<v1::LeafUpdate> leaves((volume.bricks.size() - 1) / share + 1);
  const float depth = 0.2F * volume.background * std::sin(static_cast<float>(frame));
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const std::size_t brick = (volume.bricks.size() - leaves.size()) / 2 + i;
    std::vector<float> values(kBrickCells);
    for (std::size_t v = 0; v < values.size(); ++v) {
      values[v] = volume.values[brick * kBrickCells + v] - depth;
    }
    leaves[i].set_x(kBrickEdge * volume.bricks[brick].x);
    leaves[i].set_y(kBrickEdge * volume.bricks[brick].y);
    leaves[i].set_z(kBrickEdge * volume.bricks[brick].z);
    leaves[i].set_values(values.data(), values.size() * sizeof(float));
  }
  return leaves;
}

void follow_grid(benchmark::State& state,
                 double radius,
                 std::size_t share,
                 bool statistics,
                 Transport transport = Transport::kPort) {
  Loopback loopback(transport);
  v1::MeshRequest request = loopback.request_mesh({"sphere", 1 / radius, true});
  request.set_skip_statistics(!statistics);
  const Volume volume = checked(load_volume(loopback.file("solid.vdb"), ""));
  const Cancellation never;
  const auto session = checked(loopback.client().begin_session(request, never));
  follow(state, *session,
         [&](double frame) { return session->update(breathing(volume, frame, share)); });
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  tet::start_logging("error");
  const auto add = [](const std::string& name, auto run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()  // of the server and the client
        ->UseRealTime();
  };
  constexpr int kGraded = 24;
  add("session/moon/uniform", [](auto& state) { follow_scene(state, moon, 0.0365, 0); });
  add("session/moon/graded", [](auto& state) { follow_scene(state, moon, 0.0213, kGraded); });
  add("session/sliding/graded",
      [](auto& state) { follow_scene(state, sliding, 0.0213, kGraded); });
  add("session/sliding/graded_only",
      [](auto& state) { follow_scene(state, sliding, 0.0213, kGraded, false); });
  add("session/grid/graded", [](auto& state) { follow_grid(state, 47, 100, true); });
  add("session/whole_grid/graded", [](auto& state) { follow_grid(state, 47, 1, true); });
  add("session/whole_grid/graded_only", [](auto& state) { follow_grid(state, 47, 1, false); });
  // On one host: over a socket file, and with chunks in shared memory.
  for (const auto& [way, transport] : {std::pair{"session_unix", Transport::kSocketFile},
                                       std::pair{"session_shared", Transport::kSharedMemory}}) {
    const std::string name = way;
    add(name + "/sliding/graded_only", [transport = transport](auto& state) {
      follow_scene(state, sliding, 0.0213, kGraded, false, transport);
    });
    add(name + "/grid/graded",
        [transport = transport](auto& state) { follow_grid(state, 47, 100, true, transport); });
    add(name + "/whole_grid/graded_only",
        [transport = transport](auto& state) { follow_grid(state, 47, 1, false, transport); });
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
