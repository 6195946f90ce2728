// The public library, beside a real server.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using test::collected;
using test::Collected;
using test::expect_same;
using test::LibraryOnAServer;

Request both_sides() {
  return {.preset = Preset::kBothSides, .box = Box{{-2, -2, -2}, {2, 2, 2}}};
}

TEST(Library, MeshesAnArray) {
  const Mesh ball = mesh(BallSamples(16).volume()).value();
  EXPECT_GT(ball.tet_count(), 10'000U);
  ASSERT_TRUE(ball.statistics().quality && ball.statistics().boundary);
  EXPECT_NEAR(ball.statistics().quality->volume, 4.18879, 0.02);
  EXPECT_GE(ball.statistics().quality->min_dihedral_deg, 11.2);
  EXPECT_EQ(ball.statistics().boundary->euler_characteristic, 2);
  for (std::size_t i = 0; i < ball.vertex_count(); ++i) {
    const auto [x, y, z] = ball.vertex(i);
    ASSERT_LT(std::hypot(x, y, z), 1.01);
  }
}

TEST(Library, ClosesWhatTouchesTheArraysEdge) {
  const std::vector<float> full(8 * 8 * 8, 1);
  const auto cube = Volume::from_samples(
      {.values = full, .size = {8, 8, 8}, .spacing = 0.5, .kind = VolumeKind::kDensity});
  const Mesh made = mesh(cube.value()).value();
  EXPECT_NEAR(made.statistics().quality->volume, 64, 4);  // half a voxel beyond every sample
  EXPECT_EQ(made.statistics().boundary->components, 1U);
}

TEST(Library, SaysWhatIsWrongWithAnArray) {
  const std::vector<float> values(8, 1);
  const auto message = [&](SampleArray samples) {
    const auto volume = Volume::from_samples(samples);
    EXPECT_EQ(volume.status().code(), StatusCode::kInvalidArgument);
    return volume.status().message();
  };
  EXPECT_EQ(message({.values = values, .size = {2, 2, 3}}),
            "size 2 x 2 x 3 does not agree with 8 values");
  EXPECT_EQ(message({.values = values, .size = {2, 2, 2}, .spacing = 0}),
            "spacing 0 is not positive");
  EXPECT_THROW((void)Volume::from_samples({}).value(), Error);
}

TEST(Library, MakesTheSameMeshOfAVolumeThatWasWritten) {
  const tet::test::TestFolder folder;
  // The mean of three squares of 0.06 or 0.3 is another number than the square.
  for (const double spacing : {0.0625, 0.06, 0.3, 1e-6}) {
    SCOPED_TRACE(spacing);
    const BallSamples ball(16);
    SampleArray array = ball.array();
    array.spacing = spacing;
    const Volume volume = Volume::from_samples(array).value();
    ASSERT_TRUE(volume.write_vdb(folder.file("ball.vdb")).ok());
    const auto read = Volume::from_vdb(folder.file("ball.vdb"), {.trusted = true});
    const auto decoded = Volume::from_vdb(folder.file("ball.vdb"));
    ASSERT_TRUE(read.ok() && decoded.ok()) << decoded.status().to_string();
    EXPECT_EQ(read->voxel_size(), volume.voxel_size());
    expect_same(mesh(*read).value(), mesh(volume).value());
    expect_same(mesh(*decoded).value(), mesh(volume).value());
  }
}

TEST(Library, MeshesTriangles) {
  const std::vector<double> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<std::uint32_t> faces{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const auto volume = Volume::from_triangles({points, faces}, 0.05);
  ASSERT_TRUE(volume.ok()) << volume.status().to_string();
  EXPECT_NEAR(mesh(*volume).value().statistics().quality->volume, 1.0 / 6, 0.01);
  const std::vector<std::uint32_t> beyond{0, 1, 4};
  EXPECT_EQ(Volume::from_triangles({points, beyond}, 0.05).status().message(),
            "triangle 0 refers to vertex 4, and there are 4");
}

TEST(Library, StreamsTheMeshThatItMakes) {
  const Volume ball = BallSamples(24).volume();
  Request with_field{.levels = 0, .fields = {{"distance", ball}}};
  for (const Request& request :
       {Request{}, both_sides(), with_field, Request{.improve = true}}) {
    const Mesh whole = mesh(ball, request).value();
    for (const int threads : {1, 3}) {
      const Collected chunks = collected(stream(ball, request, {.threads = threads}));
      expect_same(chunks, whole);
      EXPECT_EQ(chunks.header.field_values, whole.header().field_values);
    }
  }
}

TEST(Library, TellsTheSameStatisticsOfAStream) {
  const Volume ball = BallSamples(24).volume();
  const Mesh whole = mesh(ball).value();
  Statistics told;
  ASSERT_TRUE(
      drain(stream(ball), {.statistics = [&](const Statistics& end) { told = end; }}).ok());
  ASSERT_TRUE(told.quality && told.boundary);
  EXPECT_EQ(told.quality->histogram, whole.statistics().quality->histogram);
  EXPECT_EQ(told.quality->volume, whole.statistics().quality->volume);
  EXPECT_EQ(told.boundary->triangles, whole.statistics().boundary->triangles);
}

TEST(Library, StopsAStreamWhereACallbackSaysSo) {
  int chunks = 0;
  bool began = false;
  const Status status = drain(stream(BallSamples(24).volume(), {.levels = 0}),
                              {.header = [&](const MeshHeader&) { return began = true; },
                               .chunk = [&](const Chunk&) { return began && ++chunks < 2; }});
  EXPECT_EQ(status.code(), StatusCode::kCancelled);
  EXPECT_EQ(chunks, 2);
}

TEST(Library, StopsWhenItIsAsked) {
  std::stop_source stop;
  stop.request_stop();
  const Volume ball = BallSamples(16).volume();
  EXPECT_EQ(mesh(ball, {}, {.stop = stop.get_token()}).status().code(), StatusCode::kCancelled);
  EXPECT_EQ(stream(ball, {}, {.stop = stop.get_token()}).header().status().code(),
            StatusCode::kCancelled);
  const auto past = std::chrono::system_clock::now() - std::chrono::seconds(1);
  EXPECT_EQ(mesh(ball, {}, {.deadline = past}).status().code(), StatusCode::kDeadlineExceeded);
}

TEST(Library, SaysThatThereIsMoreToCome) {
  MeshStream chunks = stream(BallSamples(8).volume());
  EXPECT_EQ(chunks.finish().status().code(), StatusCode::kFailedPrecondition);
}

TEST(Library, MeshesTheSideThatTheRequestSays) {
  const Volume ball = BallSamples(16).volume();
  const double below =
      mesh(ball, {.inside = Inside::kBelow}).value().statistics().quality->volume;
  EXPECT_EQ(below, mesh(ball).value().statistics().quality->volume);
  const Box box{{-2, -2, -2}, {2, 2, 2}};
  const Mesh rest = mesh(ball, {.inside = Inside::kAbove, .box = box}).value();
  const Mesh whole = mesh(ball, {.inside = Inside::kBelow, .box = box}).value();
  EXPECT_GT(rest.statistics().quality->volume, 4 * whole.statistics().quality->volume);
  EXPECT_EQ(rest.header().inside_guess, "");
}

TEST(Library, NamesTheFieldOfARequestThatIsWrong) {
  const Volume ball = BallSamples(8).volume();
  EXPECT_EQ(mesh(ball, {.spacing = 0}).status().code(), StatusCode::kInvalidArgument);
  const Status sizing = mesh(ball, {.sizing = "{\"growth\": \"a lot\"}"}).status();
  EXPECT_EQ(sizing.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(sizing.message().substr(0, 7), "sizing:");
}

TEST(Library, EstimatesWhatItMakes) {
  const Volume ball = BallSamples(16).volume();
  const auto counted = estimate(ball);
  ASSERT_TRUE(counted.ok()) << counted.status().to_string();
  EXPECT_EQ(counted->tet_count, mesh(ball).value().tet_count());
  EXPECT_GT(counted->bytes, 16 * counted->tet_count);
}

TEST(Library, WritesFiles) {
  const tet::test::TestFolder folder;
  const Mesh ball = mesh(BallSamples(8).volume()).value();
  EXPECT_TRUE(write_mesh_file(folder.file("ball.vtu"), ball).ok());
  EXPECT_GT(std::filesystem::file_size(folder.file("ball.vtu")), 10'000U);
  EXPECT_EQ(write_mesh_file(folder.file("ball.med"), ball).code(),
            StatusCode::kInvalidArgument);
}

TEST(Library, WritesFilesOfAFormatThatIsNamed) {
  const tet::test::TestFolder folder;
  const Mesh ball = mesh(BallSamples(8).volume()).value();
  EXPECT_TRUE(write_mesh_file(folder.file("deck"), ball, "inp").ok());
  EXPECT_TRUE(write_mesh_file(folder.file("ball.inp"), ball).ok());
  EXPECT_EQ(std::filesystem::file_size(folder.file("deck")),
            std::filesystem::file_size(folder.file("ball.inp")));
  EXPECT_EQ(write_mesh_file(folder.file("ball.inp"), ball, "med").code(),
            StatusCode::kInvalidArgument);
}

TEST_F(LibraryOnAServer, MakesTheMeshThatIsMadeHere) {
  const Volume ball = BallSamples(16).volume();
  const StoredVolume stored = client().upload(ball).value();
  Request with_field{.levels = 0, .fields = {{"distance", ball}}};
  for (const Request& request : {Request{}, both_sides(), with_field}) {
    const Mesh here = mesh(ball, request).value();
    const Mesh there = client().mesh(stored, request).value();
    expect_same(there, here);
    expect_same(collected(client().stream(stored, request)), here);
    EXPECT_FALSE(there.header().id.empty());
  }
}

TEST_F(LibraryOnAServer, TakesFieldsThatItStores) {
  const Volume ball = BallSamples(16).volume();
  const StoredVolume stored = client().upload(ball).value();
  const Request here{.levels = 0, .fields = {{"distance", ball}}};
  const Request there{.levels = 0, .fields = {{"distance", std::nullopt, stored}}};
  expect_same(client().mesh(stored, there).value(), mesh(ball, here).value());
  EXPECT_EQ(mesh(ball, there).status().code(), StatusCode::kInvalidArgument);
  const Request nothing{.fields = {{"distance"}}};
  EXPECT_EQ(client().mesh(stored, nothing).status().code(), StatusCode::kInvalidArgument);
}

TEST_F(LibraryOnAServer, StreamsEveryEncoding) {
  const StoredVolume ball = client().upload_file(ball_file(16)).value();
  const Mesh whole = client().mesh(ball).value();
  for (const Encoding encoding : {Encoding::kPlain, Encoding::kPacked, Encoding::kCompact}) {
    StreamOptions options;
    options.encoding = encoding;
    expect_same(collected(client().stream(ball, {}, options)), whole);
  }
}

TEST_F(LibraryOnAServer, LetsTheServerGoWhenAStreamIsGivenUp) {
  const StoredVolume ball = client().upload_file(ball_file(48)).value();
  {
    MeshStream held = client().stream(ball, {.levels = 0});
    ASSERT_NE(held.next(), nullptr);
    EXPECT_EQ(activity().meshes, 1);
  }
  EXPECT_TRUE(work_stops());
}

TEST_F(LibraryOnAServer, StopsWhenItIsAsked) {
  const StoredVolume ball = client().upload_file(ball_file(48)).value();
  std::stop_source stop;
  StreamOptions options;
  options.stop = stop.get_token();
  MeshStream held = client().stream(ball, {.levels = 0}, options);
  ASSERT_NE(held.next(), nullptr);
  stop.request_stop();
  while (held.next() != nullptr) {
  }
  EXPECT_EQ(held.finish().status().code(), StatusCode::kCancelled);
  EXPECT_TRUE(work_stops());
}

TEST_F(LibraryOnAServer, TellsWhatTheServerSays) {
  EXPECT_TRUE(client().health().ok());
  EXPECT_GT(client().capabilities().value().max_tets, 0U);
  const StoredVolume ball = client().upload_file(ball_file(8)).value();
  EXPECT_EQ(client().estimate(ball).value().tet_count, client().mesh(ball).value().tet_count());
  const auto missing = client().mesh({"grids/" + std::string(64, '0')});
  EXPECT_EQ(missing.status().code(), StatusCode::kNotFound);
  EXPECT_EQ(missing.status().reason(), "GRID_NOT_FOUND");
}

TEST_F(LibraryOnAServer, RefusesToShowATokenToEverybody) {
  EXPECT_EQ(Client::connect("192.0.2.1:443", {.token = "secret"}).status().code(),
            StatusCode::kFailedPrecondition);
  EXPECT_TRUE(Client::connect(server_->address(), {.token = "secret"}).ok());
}

}  // namespace
}  // namespace tetstream
