// What the tests of the public library mesh, and how they compare meshes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/api/mesh_impl.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/service_fixture.h"
#include "tetstream/tetstream.h"

namespace tetstream::test {

/// A ball of radius 1, as distances at points 1/`radius` apart.
struct BallSamples {
  explicit BallSamples(int radius)
      : edge(static_cast<std::size_t>(2 * radius + 9)), spacing(1.0 / radius) {
    const auto coordinate = [&](std::size_t i) {
      return spacing * (static_cast<double>(i) - static_cast<double>(radius + 4));
    };
    for (std::size_t x = 0; x < edge; ++x) {
      for (std::size_t y = 0; y < edge; ++y) {
        for (std::size_t z = 0; z < edge; ++z) {
          values.push_back(
              static_cast<float>(std::hypot(coordinate(x), coordinate(y), coordinate(z)) - 1));
        }
      }
    }
  }

  SampleArray array() const {
    const std::size_t centre = edge / 2;
    const double low = -spacing * static_cast<double>(centre);
    return {.values = values,
            .size = {edge, edge, edge},
            .spacing = spacing,
            .origin = {low, low, low}};
  }
  Volume volume() const { return Volume::from_samples(array()).value(); }

  std::size_t edge;
  double spacing;
  std::vector<float> values;
};

/// What two balls of radius 1 have in common.
inline Scene lens(double offset) {
  return Scene::from_json(R"({"nodes": [{"name": "ball", "sphere": {"radius": 1}},
    {"name": "other", "transform": {"of": "ball", "translation": [)" +
                          std::to_string(offset) + R"(, 0, 0]}},
    {"intersection": {"of": ["ball", "other"]}}]})")
      .value();
}

/// A mesh put together from what a sink is given.
struct Collected {
  explicit Collected(const MeshHeader& head) : header(head) {}

  void add(const Chunk& chunk) {
    EXPECT_EQ(chunk.index, chunks++);
    EXPECT_EQ(chunk.first_vertex, points.size() / 3);
    EXPECT_EQ(chunk.first_tet, tets.size() / 4);
    const MeshColumns& columns = chunk.columns;
    EXPECT_EQ(columns.vertex_count(), chunk.vertex_count);
    EXPECT_EQ(columns.tet_count(), chunk.tet_count);
    points.insert(points.end(), columns.points32.begin(), columns.points32.end());
    tets.insert(tets.end(), columns.tets32.begin(), columns.tets32.end());
    regions.insert(regions.end(), columns.regions.begin(), columns.regions.end());
    labels.insert(labels.end(), columns.labels.begin(), columns.labels.end());
    fields.insert(fields.end(), columns.fields.begin(), columns.fields.end());
  }

  MeshHeader header;
  std::uint64_t chunks = 0;
  std::vector<float> points, fields;
  std::vector<std::uint32_t> tets;
  std::vector<std::uint8_t> regions;
  std::vector<std::uint16_t> labels;
};

inline Collected collected(MeshStream stream) {
  Collected all(stream.header().value());
  while (const Chunk* const chunk = stream.next()) all.add(*chunk);
  const auto end = stream.finish();
  EXPECT_TRUE(end.ok()) << end.status().to_string();
  return all;
}

inline void expect_same(const Collected& chunks, const Mesh& mesh) {
  const MeshColumns& columns = mesh.columns();
  EXPECT_EQ(chunks.chunks, mesh.header().chunk_count);
  EXPECT_TRUE(std::ranges::equal(chunks.points, columns.points32));
  EXPECT_TRUE(std::ranges::equal(chunks.tets, columns.tets32));
  EXPECT_TRUE(std::ranges::equal(chunks.regions, columns.regions));
  EXPECT_TRUE(std::ranges::equal(chunks.labels, columns.labels));
  EXPECT_TRUE(std::ranges::equal(chunks.fields, columns.fields));
}

inline void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_TRUE(tet::test::same_bytes(a.impl().mesh, b.impl().mesh));
  EXPECT_EQ(a.header().origin, b.header().origin);
}

/// A server, and a client of the library that is connected to it.
class LibraryOnAServer : public tet::test::ServiceTest {
 protected:
  explicit LibraryOnAServer(std::uint64_t job_workers = tet::Config().job_workers) {
    config_.jobs.clear();  // beside its store
    config_.job_workers = job_workers;
    start();
    client_of_ours_ = Client::connect(server_->address()).value();
  }
  const Client& client() const { return *client_of_ours_; }

 private:
  std::optional<Client> client_of_ours_;
};

}  // namespace tetstream::test
