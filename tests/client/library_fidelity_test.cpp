// Fidelity that is asked for, here and of a server.
#include <string>

#include <gtest/gtest.h>

#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using FidelityOnAServer = test::LibraryOnAServer;

void expect_equal(const Statistics::SurfaceDistance& a, const Statistics::SurfaceDistance& b) {
  EXPECT_EQ(a.max, b.max);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.at, b.at);
  EXPECT_EQ(a.samples, b.samples);
}

void expect_equal(const Statistics::Ratio& a, const Statistics::Ratio& b) {
  EXPECT_EQ(a.min, b.min);
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.max, b.max);
  EXPECT_EQ(a.histogram, b.histogram);
}

void expect_equal(const Statistics& a, const Statistics& b) {
  ASSERT_EQ(a.fidelity.size(), b.fidelity.size());
  for (std::size_t i = 0; i < a.fidelity.size(); ++i) {
    const Statistics::Fidelity &one = a.fidelity[i], &other = b.fidelity[i];
    expect_equal(one.mesh_to_surface, other.mesh_to_surface);
    expect_equal(one.surface_to_mesh, other.surface_to_mesh);
    EXPECT_EQ(one.spacing, other.spacing);
    EXPECT_EQ(one.mesh_area, other.mesh_area);
    EXPECT_EQ(one.surface_area, other.surface_area);
    EXPECT_EQ(one.mesh_volume, other.mesh_volume);
    EXPECT_EQ(one.enclosed_volume, other.enclosed_volume);
  }
  ASSERT_TRUE(a.shapes && b.shapes);
  expect_equal(a.shapes->scaled_jacobian, b.shapes->scaled_jacobian);
  expect_equal(a.shapes->radius_ratio, b.shapes->radius_ratio);
  expect_equal(a.shapes->edge_ratio, b.shapes->edge_ratio);
  EXPECT_EQ(a.shapes->shortest_edge, b.shapes->shortest_edge);
  EXPECT_EQ(a.shapes->longest_edge, b.shapes->longest_edge);
  EXPECT_EQ(a.shapes->not_positive, b.shapes->not_positive);
}

Statistics statistics_of(MeshStream stream) {
  while (stream.next() != nullptr) {
  }
  const auto statistics = stream.finish();
  EXPECT_TRUE(statistics.ok()) << statistics.status().to_string();
  return statistics.ok() ? *statistics : Statistics{};
}

TEST_F(FidelityOnAServer, IsWhatItIsHereHoweverChunksCome) {
  const Volume ball = BallSamples(12).volume();
  const Request request{.fidelity = true};
  const Mesh made = mesh(ball, request).value();
  const Statistics here = made.statistics();
  ASSERT_EQ(here.fidelity.size(), 1U);
  EXPECT_NEAR(*here.fidelity[0].enclosed_volume, 4.18879, 0.02);
  EXPECT_LT(here.fidelity[0].hausdorff(), 0.1 * here.fidelity[0].spacing);
  EXPECT_GT(made.face_count(), 0U);
  expect_equal(statistics_of(stream(ball, request)), here);

  const StoredVolume stored = client().upload(ball).value();
  for (const Encoding encoding : {Encoding::kPlain, Encoding::kPacked, Encoding::kCompact}) {
    StreamOptions options;
    options.encoding = encoding;
    expect_equal(client().mesh(stored, request, options).value().statistics(), here);
    expect_equal(statistics_of(client().stream(stored, request, options)), here);
  }
  const Request faces{.faces = true};
  EXPECT_EQ(client().mesh(stored, request).value().header().id,
            client().mesh(stored, faces).value().header().id);
  EXPECT_TRUE(client().mesh(stored, faces).value().statistics().fidelity.empty());
  // Either is measured anew each time, by the clock: what else the machine did may be in it.
  EXPECT_TRUE(tet::test::eventually([&] {
    return client().estimate(stored, request).value().seconds >
           client().estimate(stored, faces).value().seconds;
  }));
}

TEST_F(FidelityOnAServer, IsRefusedToASessionHereAndThere) {
  const Volume ball = BallSamples(8).volume();
  const Request request{.fidelity = true};
  const std::string message =
      "fidelity does not go with a session: stream the mesh of the frame that is to be "
      "measured";
  EXPECT_EQ(begin_session(ball, request).status().message(), message);
}

}  // namespace
}  // namespace tetstream
