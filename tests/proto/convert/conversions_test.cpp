// What core makes comes back from its message as it was, and a message that cannot be is
// refused with its field.
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/chunk_numbers.h"
#include "proto/convert/counts.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/mesh_parts.h"
#include "proto/convert/request.h"
#include "proto/convert/statistics.h"
#include "proto/wire/sha256.h"

namespace tet {
namespace {

using testing::StartsWith;

constexpr int kRounds = 200;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Numbers of all sizes, the largest among them.
class RandomNumbers {
 public:
  explicit RandomNumbers(unsigned seed) : bits_(seed) {}

  std::uint64_t count() {
    const auto shift = std::uniform_int_distribution<unsigned>(0, 48)(bits_);
    const std::uint64_t most = std::uint64_t{1} << shift;
    return std::uniform_int_distribution<std::uint64_t>(0, most)(bits_);
  }
  double number() { return std::ldexp(positive() - 0.5, small(100) - 50); }
  double positive() { return std::uniform_real_distribution<double>(0, 1)(bits_); }
  int small(int end) { return std::uniform_int_distribution<int>(0, end - 1)(bits_); }
  bool either() { return small(2) == 1; }
  WorldPoint point() { return {number(), number(), number()}; }
  WorldBox box() { return {point(), point()}; }
  WorldBox box_with_inside() {
    const WorldPoint low = point();
    return {low,
            {low.x + size_from(low.x), low.y + size_from(low.y), low.z + size_from(low.z)}};
  }

 private:
  double size_from(double low) { return std::abs(low) + 1 + positive(); }

  std::mt19937 bits_;
};

std::array<WorldPoint, 2> corners_of(const WorldBox& box) { return {box.min, box.max}; }

/// Through the bytes, as it travels.
template <class Message, class Core>
Message sent(const Core& core) {
  Message message;
  to_proto(core, message);
  Message received;
  EXPECT_TRUE(received.ParseFromString(message.SerializeAsString()));
  return received;
}

MeshHeader random_header(RandomNumbers& random) {
  MeshHeader header;
  header.chunk_count = random.count();
  header.coordinate_type =
      random.either() ? CoordinateType::kFloat32 : CoordinateType::kFloat64;
  header.index_type = random.either() ? IndexType::kUint32 : IndexType::kUint64;
  header.has_regions = random.either();
  header.origin = random.point();
  header.bounds = random.box();
  header.spacing = random.positive();
  header.levels = random.small(kMaxLevels + 1);
  for (int i = random.small(18); i > 0; --i) {
    header.fields.push_back({"array " + std::to_string(i), random.either() ? 1U : 3U});
  }
  for (int i = random.small(5); i > 0; --i) {
    const std::uint64_t vertices = random.count() >> 8, tets = random.count() >> 8;
    header.parts.push_back({"grid " + std::to_string(i), header.vertex_count, vertices,
                            header.tet_count, tets, random.positive(),
                            random.small(kMaxLevels + 1)});
    header.vertex_count += vertices;
    header.tet_count += tets;
  }
  if (!header.parts.empty()) return header;
  header.vertex_count = random.count();
  header.tet_count = random.count();
  return header;
}

TEST(Conversions, BringAHeaderBack) {
  RandomNumbers random(1);
  for (int i = 0; i < kRounds; ++i) {
    const MeshHeader header = random_header(random);
    const auto back = from_proto(sent<v1::MeshHeader>(header));
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->vertex_count, header.vertex_count);
    EXPECT_EQ(back->tet_count, header.tet_count);
    EXPECT_EQ(back->chunk_count, header.chunk_count);
    EXPECT_EQ(back->coordinate_type, header.coordinate_type);
    EXPECT_EQ(back->index_type, header.index_type);
    EXPECT_EQ(back->has_regions, header.has_regions);
    EXPECT_EQ(back->origin, header.origin);
    EXPECT_EQ(corners_of(back->bounds), corners_of(header.bounds));
    EXPECT_EQ(back->spacing, header.spacing);
    EXPECT_EQ(back->levels, header.levels);
    EXPECT_EQ(back->fields, header.fields);
    EXPECT_EQ(back->parts, header.parts);
  }
}

MeshHeader header_with_faces() {
  MeshHeader header;
  header.vertex_count = 4;
  header.tet_count = 1;
  header.face_count = 4;
  header.parts = {{"femur", 0, 4, 0, 1, 1, 0}};
  header.face_labels = {{"femur_surface", FaceKind::kSurface, 1},
                        {"femur_cut_x_min", FaceKind::kBox, 1},
                        {"sides", FaceKind::kInterface, 0},
                        {"bore", FaceKind::kRegion, 0}};
  return header;
}

TEST(Conversions, BringTheLabelsOfFacesBack) {
  const MeshHeader header = header_with_faces();
  const auto back = from_proto(sent<v1::MeshHeader>(header));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->face_labels, header.face_labels);
  EXPECT_EQ(back->face_count, 4U);
}

TEST(Conversions, TakeNoFacesThatCannotBe) {
  const auto refused = [](auto&& spoil) {
    auto message = sent<v1::MeshHeader>(header_with_faces());
    spoil(message);
    return !from_proto(message).ok();
  };
  EXPECT_FALSE(refused([](v1::MeshHeader&) {}));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.set_face_count(-1); }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.set_face_count(8); })) << "of one tet";
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.clear_face_labels(); }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) {
    m.mutable_face_labels(1)->set_name("femur_surface");
  })) << "twice";
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.mutable_face_labels(0)->set_name("\n"); }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.mutable_face_labels(0)->clear_name(); }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.mutable_face_labels(0)->set_part(2); }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) { m.mutable_face_labels(0)->clear_kind(); }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) {
    for (int i = 0; i < 1024; ++i) {
      v1::FaceLabel& label = *m.add_face_labels();
      label.set_name(std::to_string(i));
      label.set_kind(v1::FACE_KIND_REGION);
    }
  }));
  EXPECT_TRUE(refused([](v1::MeshHeader& m) {
    m.clear_parts();
    m.mutable_face_labels(0)->clear_part();
    m.mutable_face_labels(1)->clear_part();
    m.set_tet_count(std::int64_t{1} << 33);
  })) << "numbers of tets that ids of 4 bytes cannot hold";
}

TEST(Conversions, BringStatisticsBack) {
  RandomNumbers random(2);
  for (int i = 0; i < kRounds; ++i) {
    QualityStats stats{random.number(), random.number(), random.number(), {}};
    for (std::uint64_t& count : stats.histogram) count = random.count();
    const auto quality = from_proto(sent<v1::QualityStats>(stats));
    ASSERT_TRUE(quality.ok()) << quality.status();
    EXPECT_EQ(quality->min_dihedral_deg, stats.min_dihedral_deg);
    EXPECT_EQ(quality->max_dihedral_deg, stats.max_dihedral_deg);
    EXPECT_EQ(quality->volume, stats.volume);
    EXPECT_EQ(quality->histogram, stats.histogram);

    const BoundaryTopology boundary{random.count(),   random.count(), random.count(),
                                    -random.small(9), random.count(), random.count(),
                                    random.count()};
    const auto topology = from_proto(sent<v1::BoundaryTopology>(boundary));
    ASSERT_TRUE(topology.ok()) << topology.status();
    EXPECT_EQ(*topology, boundary);

    const Improvement improvement{random.number(), random.number(), random.count(),
                                  random.positive()};
    const auto improved = from_proto(sent<v1::Improvement>(improvement));
    ASSERT_TRUE(improved.ok()) << improved.status();
    EXPECT_EQ(improved->min_dihedral_before_deg, improvement.min_dihedral_before_deg);
    EXPECT_EQ(improved->max_dihedral_before_deg, improvement.max_dihedral_before_deg);
    EXPECT_EQ(improved->moved_vertices, improvement.moved_vertices);
    EXPECT_EQ(improved->seconds, improvement.seconds);
  }
}

TEST(Conversions, BringThinWallsBack) {
  RandomNumbers random(3);
  for (int i = 0; i < kRounds; ++i) {
    ThinWalls walls;
    walls.inside = random.count();
    walls.outside = random.count();
    walls.region_count = random.count();
    walls.thickness = random.positive();
    walls.suggested_spacing = random.positive();
    for (int j = random.small(17); j > 0; --j) {
      walls.regions.push_back({random.box(), random.count(), random.count()});
    }
    const auto back = from_proto(sent<v1::ThinWalls>(walls));
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->inside, walls.inside);
    EXPECT_EQ(back->outside, walls.outside);
    EXPECT_EQ(back->region_count, walls.region_count);
    EXPECT_EQ(back->thickness, walls.thickness);
    EXPECT_EQ(back->suggested_spacing, walls.suggested_spacing);
    ASSERT_EQ(back->regions.size(), walls.regions.size());
    for (std::size_t j = 0; j < walls.regions.size(); ++j) {
      EXPECT_EQ(corners_of(back->regions[j].box), corners_of(walls.regions[j].box));
      EXPECT_EQ(back->regions[j].inside, walls.regions[j].inside);
      EXPECT_EQ(back->regions[j].outside, walls.regions[j].outside);
    }
  }
}

TEST(Conversions, BringKeptPartsLatticesAndChunkNumbersBack) {
  RandomNumbers random(4);
  for (int i = 0; i < kRounds; ++i) {
    KeptParts kept;
    for (int j = random.small(9); j > 0; --j) {
      kept.vertices.push_back({random.count(), random.count(), random.count()});
      kept.tets.push_back({random.count(), random.count(), random.count()});
    }
    const auto parts = from_proto(sent<v1::KeptParts>(kept));
    ASSERT_TRUE(parts.ok()) << parts.status();
    EXPECT_EQ(parts->vertices, kept.vertices);
    EXPECT_EQ(parts->tets, kept.tets);

    KeptParts loose{{}, {}, true};
    KeptRun end;
    for (int j = random.small(9); j > 0; --j) {
      const auto gap = [&] { return static_cast<std::uint64_t>(random.small(200)); };
      const KeptRun run{end.from + gap(), end.to + gap(), gap()};
      loose.vertices.push_back(run);
      loose.tets.insert(loose.tets.begin(), run);
      end = {run.from + run.count, run.to + run.count, 0};
    }
    loose.tets.resize(std::min<std::size_t>(loose.tets.size(), 1));
    const auto loose_parts = from_proto(sent<v1::KeptParts>(loose));
    ASSERT_TRUE(loose_parts.ok()) << loose_parts.status();
    EXPECT_TRUE(loose_parts->loose);
    EXPECT_EQ(loose_parts->vertices, loose.vertices);
    EXPECT_EQ(loose_parts->tets, loose.tets);

    LatticeToWorld lattice;
    for (auto& row : lattice.linear) {
      for (double& entry : row) entry = random.number();
    }
    lattice.origin = {random.small(99) - 50, random.small(99) - 50, random.small(99) - 50};
    const auto placed = from_proto(sent<v1::Lattice>(lattice));
    ASSERT_TRUE(placed.ok()) << placed.status();
    EXPECT_EQ(placed->linear, lattice.linear);
    EXPECT_EQ(placed->origin.x, lattice.origin.x);
    EXPECT_EQ(placed->origin.y, lattice.origin.y);
    EXPECT_EQ(placed->origin.z, lattice.origin.z);

    const ChunkNumbers numbers{random.count(), random.count(), random.count(), random.count(),
                               random.count(), 0xdeadbeef,     random.count(), random.count()};
    const ChunkNumbers chunk = from_proto(sent<v1::MeshChunk>(numbers));
    EXPECT_EQ(chunk.index, numbers.index);
    EXPECT_EQ(chunk.first_vertex, numbers.first_vertex);
    EXPECT_EQ(chunk.vertex_count, numbers.vertex_count);
    EXPECT_EQ(chunk.first_tet, numbers.first_tet);
    EXPECT_EQ(chunk.tet_count, numbers.tet_count);
    EXPECT_EQ(chunk.checksum, numbers.checksum);
    EXPECT_EQ(chunk.first_face, numbers.first_face);
    EXPECT_EQ(chunk.face_count, numbers.face_count);
  }
}

MeshRequest random_request(RandomNumbers& random) {
  MeshRequest request;
  if (random.either()) request.spacing = 1e-3 * (random.positive() + 1);
  if (random.either()) request.iso = random.number();
  request.levels = random.small(kMaxLevels + 1);
  request.preset = kPresets[static_cast<std::size_t>(random.small(3))];
  if (random.either()) request.box = random.box_with_inside();
  if (random.either()) request.origin = random.point();
  if (random.either()) request.coordinates = CoordinateType::kFloat64;
  request.manifold = random.either() && !has_cut(request);
  request.improve = random.either();
  request.skip_statistics = random.either();
  request.faces = random.either();
  if (random.either()) request.sizing.coarsest = 1 + random.positive();
  if (random.either()) request.sizing.growth = 0.5 + random.positive() / 2;
  if (random.either())
    request.fields.push_back({"heat", name_of_grid(std::string(64, 'b')), "t"});
  return request;
}

TEST(Conversions, BringARequestBack) {
  RandomNumbers random(5);
  for (int i = 0; i < kRounds; ++i) {
    const MeshRequest request = random_request(random);
    auto message = sent<v1::MeshRequest>(request);
    message.set_name(name_of_grid(std::string(64, 'a')));
    const auto order = parse_mesh_request(message);
    ASSERT_TRUE(order.ok()) << order.status();
    const MeshRequest& back = order->request;
    EXPECT_EQ(back.spacing, request.spacing);
    EXPECT_EQ(back.iso, request.iso);
    EXPECT_EQ(back.levels, request.levels);
    EXPECT_EQ(back.preset, request.preset);
    ASSERT_EQ(back.box.has_value(), request.box.has_value());
    if (back.box) {
      EXPECT_EQ(corners_of(*back.box), corners_of(*request.box));
    }
    EXPECT_EQ(back.origin, request.origin);
    EXPECT_EQ(back.coordinates, request.coordinates);
    EXPECT_EQ(back.manifold, request.manifold);
    EXPECT_EQ(back.improve, request.improve);
    EXPECT_EQ(back.skip_statistics, request.skip_statistics);
    EXPECT_EQ(back.faces, request.faces);
    EXPECT_EQ(back.sizing.coarsest, request.sizing.coarsest);
    EXPECT_EQ(back.sizing.growth, request.sizing.growth);
    ASSERT_EQ(back.fields.size(), request.fields.size());
    for (std::size_t j = 0; j < back.fields.size(); ++j) {
      EXPECT_EQ(back.fields[j].name, request.fields[j].name);
      EXPECT_EQ(back.fields[j].file, request.fields[j].file);
      EXPECT_EQ(back.fields[j].grid, request.fields[j].grid);
    }
  }
}

/// Every change of a message that can be makes one that cannot be.
template <class Message>
void expect_refused(const Message& valid,
                    const std::vector<std::pair<const char*, void (*)(Message&)>>& changes) {
  EXPECT_TRUE(from_proto(valid).ok()) << from_proto(valid).status();
  for (const auto& [field, change] : changes) {
    Message hostile = valid;
    change(hostile);
    const absl::Status status = from_proto(hostile).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << hostile.ShortDebugString();
    EXPECT_THAT(std::string(status.message()), StartsWith(field));
  }
}

v1::MeshHeader valid_header() {
  MeshHeader header;
  header.vertex_count = 4;
  header.tet_count = 1;
  header.fields = {{"heat", 1}};
  header.parts = {{"femur", 0, 3, 0, 1, 0.5, 2}, {"tibia", 3, 1, 1, 0, 0.5, 2}};
  return sent<v1::MeshHeader>(header);
}

TEST(Conversions, RefuseAHostileHeader) {
  using M = v1::MeshHeader;
  expect_refused<M>(
      valid_header(),
      {{"vertex_count", [](M& m) { m.set_vertex_count(-1); }},
       {"vertex_count", [](M& m) { m.set_vertex_count(kMaxCount + 1); }},
       {"tet_count", [](M& m) { m.set_tet_count(std::numeric_limits<std::int64_t>::min()); }},
       {"chunk_count",
        [](M& m) { m.set_chunk_count(std::numeric_limits<std::int64_t>::max()); }},
       {"coordinate_type", [](M& m) { m.clear_coordinate_type(); }},
       {"coordinate_type",
        [](M& m) { m.set_coordinate_type(static_cast<v1::CoordinateType>(9)); }},
       {"index_type", [](M& m) { m.set_index_type(static_cast<v1::IndexType>(-1)); }},
       {"origin", [](M& m) { m.mutable_origin()->set_y(kNan); }},
       {"bounds", [](M& m) { m.mutable_bounds()->mutable_max()->set_z(kInfinity); }},
       {"spacing", [](M& m) { m.set_spacing(-1); }},
       {"spacing", [](M& m) { m.set_spacing(kNan); }},
       {"spacing 1e-46", [](M& m) { m.set_spacing(1e-46); }},
       {"levels", [](M& m) { m.set_levels(kMaxLevels + 1); }},
       {"levels", [](M& m) { m.set_levels(-1); }},
       {"fields[0]", [](M& m) { m.mutable_fields(0)->set_components(2); }},
       {"fields[0]", [](M& m) { m.mutable_fields(0)->set_name("a/b"); }},
       {"fields[1]", [](M& m) { *m.add_fields() = m.fields(0); }},
       {"parts[0]", [](M& m) { m.mutable_parts(0)->set_name("a\nb"); }},
       {"parts[1]", [](M& m) { m.mutable_parts(1)->set_first_vertex(2); }},
       {"parts[1]", [](M& m) { m.mutable_parts(1)->set_tet_count(-1); }},
       {"parts[1]", [](M& m) { m.mutable_parts(1)->set_spacing(kInfinity); }},
       {"parts[1]", [](M& m) { m.mutable_parts(1)->set_spacing(1e50); }},
       {"parts", [](M& m) { m.mutable_parts()->RemoveLast(); }}});
}

TEST(Conversions, TakeAsManyArraysAsACutMeshMayHave) {
  v1::MeshHeader message = valid_header();
  while (message.fields_size() < int{VertexField::kMaxFields} + 1) {
    v1::FieldArray& array = *message.add_fields();
    array.set_name("array " + std::to_string(message.fields_size()));
    array.set_components(1);
  }
  EXPECT_TRUE(from_proto(message).ok()) << from_proto(message).status();
  *message.add_fields() = message.fields(0);
  EXPECT_EQ(from_proto(message).status().message(), "fields has 18 entries; the limit is 17");
}

TEST(Conversions, RefuseHostileStatistics) {
  using Q = v1::QualityStats;
  expect_refused<Q>(sent<Q>(QualityStats()),
                    {{"volume", [](Q& m) { m.set_volume(kNan); }},
                     {"min_dihedral_deg", [](Q& m) { m.set_min_dihedral_deg(kInfinity); }},
                     {"dihedral_histogram", [](Q& m) { m.add_dihedral_histogram(1); }},
                     {"dihedral_histogram", [](Q& m) { m.set_dihedral_histogram(7, -1); }}});
  using B = v1::BoundaryTopology;
  expect_refused<B>(
      sent<B>(BoundaryTopology()),
      {{"triangles", [](B& m) { m.set_triangles(-1); }},
       {"restored_nodes", [](B& m) { m.set_restored_nodes(kMaxCount + 1); }},
       {"euler_characteristic", [](B& m) { m.set_euler_characteristic(-kMaxCount - 1); }}});
  using W = v1::ThinWalls;
  ThinWalls walls;
  walls.regions.emplace_back();
  expect_refused<W>(
      sent<W>(walls),
      {{"inside_spots", [](W& m) { m.set_inside_spots(-1); }},
       {"thickness", [](W& m) { m.set_thickness(kNan); }},
       {"regions[0].outside_spots", [](W& m) { m.mutable_regions(0)->set_outside_spots(-1); }},
       {"regions[0].box",
        [](W& m) { m.mutable_regions(0)->mutable_box()->mutable_min()->set_x(kNan); }}});
  using I = v1::Improvement;
  expect_refused<I>(sent<I>(Improvement()),
                    {{"moved_vertices", [](I& m) { m.set_moved_vertices(-1); }},
                     {"seconds", [](I& m) { m.set_seconds(kInfinity); }}});
}

TEST(Conversions, RefuseHostileKeptPartsAndLattices) {
  using K = v1::KeptParts;
  KeptParts kept;
  kept.vertices.push_back({1, 2, 3});
  kept.tets.push_back({1, 2, 3});
  expect_refused<K>(sent<K>(kept),
                    {{"vertices[0]", [](K& m) { m.mutable_vertices(0)->set_from(-1); }},
                     {"tets[0]", [](K& m) { m.mutable_tets(0)->set_count(kMaxCount + 1); }}});
  kept.loose = true;
  constexpr auto kMost = static_cast<std::uint64_t>(kMaxCount);
  expect_refused<K>(sent<K>(kept),
                    {{"vertex_runs has 4", [](K& m) { m.add_vertex_runs(0); }},
                     {"tet_runs[1]", [](K& m) { m.set_tet_runs(1, kMost + 1); }},
                     {"tet_runs[2]", [](K& m) { m.set_tet_runs(2, ~std::uint64_t{0}); }},
                     {"vertex_runs[0] ends", [](K& m) { m.set_vertex_runs(2, kMost); }}});
  using L = v1::Lattice;
  expect_refused<L>(sent<L>(LatticeToWorld()),
                    {{"linear", [](L& m) { m.add_linear(1); }},
                     {"linear[3]", [](L& m) { m.set_linear(3, kNan); }}});
}

}  // namespace
}  // namespace tet
