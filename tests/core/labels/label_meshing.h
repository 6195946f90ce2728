// Meshes of labels in tests.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/make/fill_mesh.h"
#include "tests/support/label_sources.h"

namespace tet::test {

struct LabelMeshing {
  BrickBox domain{{0, 0, 0}, {1, 1, 1}};
  int levels = 0;
  KeptLabels kept = {};
  int threads = 2;
  std::size_t chunk_bytes = kChunkBytes;
  CoordinateType coordinates = CoordinateType::kFloat64;
  std::size_t labels = 1000;
  bool improve = false;
};

inline LabelJob label_job(std::shared_ptr<const LabelSource> source, const LabelMeshing& how) {
  LabelJob job;
  job.source = std::move(source);
  job.domain = how.domain;
  job.kept = how.kept;
  job.labels.resize(how.labels);
  for (std::size_t i = 0; i < how.labels; ++i) {
    job.labels[i].value = static_cast<std::int64_t>(i);
  }
  job.request.levels = how.levels;
  job.request.coordinates = how.coordinates;
  job.limits.chunk_bytes = how.chunk_bytes;
  return job;
}

/// An empty mesh, and a failed test, where there is none.
inline FilledMesh mesh_of(std::shared_ptr<const LabelSource> source,
                          const LabelMeshing& how = {}) {
  TaskPool pool(how.threads);
  FilledMesh mesh;
  pool.run([&] {
    const auto plan = plan_labels(label_job(std::move(source), how));
    ASSERT_TRUE(plan.ok()) << plan.status();
    auto filled = fill_mesh(**plan, Cancellation(), nullptr);
    ASSERT_TRUE(filled.ok()) << filled.status();
    mesh = *std::move(filled);
    if (how.improve) (*plan)->improve(mesh.mesh, Cancellation());
  });
  return mesh;
}

inline FilledMesh mesh_of(const LabelFunctions& functions, const LabelMeshing& how = {}) {
  return mesh_of(std::make_shared<const FunctionLabels>(functions), how);
}

/// Tets and volume of each label.
struct LabelPart {
  std::uint64_t tets = 0;
  double volume = 0;
};

inline std::map<Label, LabelPart> parts_of(const TetMesh& mesh) {
  std::map<Label, LabelPart> parts;
  for (std::uint64_t t = 0; t < mesh.header.tet_count; ++t) {
    const auto [a, b, c, d] = mesh.view().stored_places(t);
    const auto to = [&from = a](const WorldPoint& p) {
      return std::array{p.x - from.x, p.y - from.y, p.z - from.z};
    };
    const auto u = to(b), v = to(c), w = to(d);
    LabelPart& part = parts[mesh.label(t)];
    ++part.tets;
    part.volume += (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
                    u[2] * (v[0] * w[1] - v[1] * w[0])) /
                   6;
  }
  return parts;
}

}  // namespace tet::test
