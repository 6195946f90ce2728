#include "core/mesh/find_faces.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "core/mesh/boundary.h"
#include "core/mesh/check_faces.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

using ::testing::ElementsAre;

TetMesh with_faces(TetMesh mesh) {
  add_faces(mesh);
  return mesh;
}

/// As boundary_triangles has them.
std::vector<Triangle> sorted_faces(const TetMesh& mesh) {
  std::vector<Triangle> triangles;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    triangles.push_back(sort_face(mesh.face(i)).triangle());
  }
  std::ranges::sort(triangles);
  return triangles;
}

std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  std::ranges::sort(triangles);
  return triangles;
}

/// How many faces have each label.
std::map<std::string, int> labels_of(const TetMesh& mesh) {
  std::map<std::string, int> labels;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    ++labels[mesh.header.face_labels.at(mesh.face_label(i)).name];
  }
  return labels;
}

/// Six times what the faces with a label enclose.
double six_volumes(const TetMesh& mesh, std::uint16_t label) {
  double sum = 0;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    if (mesh.face_label(i) != label) continue;
    const auto [a, b, c] = mesh.face(i);
    const WorldPoint p = mesh.vertex(a), q = mesh.vertex(b), r = mesh.vertex(c);
    sum += p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) +
           p.z * (q.x * r.y - q.y * r.x);
  }
  return sum;
}

TEST(FindFaces, GivesOneTetItsFourInTheOrderOfTheCornersOpposite) {
  for (const auto ids : {IndexType::kUint32, IndexType::kUint64}) {
    const TetMesh mesh = with_faces(one_tet({.ids = ids}));
    ASSERT_EQ(mesh.header.face_count, 4U);
    EXPECT_THAT(mesh.face(0), ElementsAre(1, 2, 3));
    EXPECT_THAT(mesh.face(1), ElementsAre(0, 3, 2));
    EXPECT_THAT(mesh.face(2), ElementsAre(0, 1, 3));
    EXPECT_THAT(mesh.face(3), ElementsAre(0, 2, 1));
    EXPECT_EQ(mesh.face_tet(3), 0U);
    EXPECT_EQ(mesh.face_tets.size(), 4 * size_of(ids));
    EXPECT_EQ(labels_of(mesh), (std::map<std::string, int>{{"surface", 4}}));
  }
}

TEST(FindFaces, FindsTheBoundaryOfAnyMeshInTheOrderOfItsTets) {
  const TetMesh mesh =
      with_faces(kuhn_mesh(9, [](int x, int y, int z) { return (x * y + 2 * z) % 5 != 1; }));
  EXPECT_EQ(sorted_faces(mesh), sorted(boundary_triangles(mesh)));
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const auto tet = mesh.tet(mesh.face_tet(i));
    bool is_one_of_the_tet = false;
    for (std::size_t k = 0; k < 4; ++k) is_one_of_the_tet |= face_of(tet, k) == mesh.face(i);
    ASSERT_TRUE(is_one_of_the_tet) << i;
    ASSERT_LE(mesh.face_tet(i == 0 ? 0 : i - 1), mesh.face_tet(i));
  }
}

/// The mesh with its vertices counted the other way round: those of its first tets come last.
TetMesh with_reversed_ids(const TetMesh& mesh) {
  std::vector<WorldPoint> positions;
  for (std::uint64_t i = mesh.header.vertex_count; i-- > 0;)
    positions.push_back(mesh.vertex(i));
  std::vector<Corners> tets;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    Corners tet = mesh.tet(i);
    for (std::uint64_t& id : tet) id = mesh.header.vertex_count - 1 - id;
    tets.push_back(tet);
  }
  return make_mesh(positions, tets);
}

TEST(FindFaces, FindsThoseOfAMeshThatSeveralTasksLookThrough) {
  constexpr int kEdge = 60;  // 1.3 million tets
  const TetMesh mesh = kuhn_mesh(kEdge);
  const std::vector<TetFace> faces = find_boundary_faces(mesh);
  EXPECT_EQ(faces.size(), std::size_t{12} * kEdge * kEdge);
  EXPECT_TRUE(std::ranges::is_sorted(faces, {}, &TetFace::index));
  EXPECT_EQ(find_boundary_faces(with_reversed_ids(mesh)), faces);
}

TEST(FindFaces, HasWhatLiesBetweenInsideAndOutsideOnceAsTheInsides) {
  // The cube in the middle of 27, and those around it.
  const TetMesh mesh =
      with_faces(with_regions(kuhn_mesh(3), [](std::uint64_t tet) { return tet / 6 == 13; }));
  EXPECT_EQ(labels_of(mesh), (std::map<std::string, int>{{"interface", 12},
                                                         {"box_x_min", 18},
                                                         {"box_x_max", 18},
                                                         {"box_y_min", 18},
                                                         {"box_y_max", 18},
                                                         {"box_z_min", 18},
                                                         {"box_z_max", 18}}));
  EXPECT_EQ(mesh.header.face_labels[0].kind, FaceKind::kInterface);
  EXPECT_DOUBLE_EQ(six_volumes(mesh, 0), 6);  // outwards of the inside
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    if (mesh.face_label(i) != 0) continue;
    EXPECT_EQ(mesh.region(mesh.face_tet(i)), MeshRegion::kInside);
  }
}

/// The lowest nine cubes of 27 have the first label, the cube in the middle the second, and
/// the others the third.
TetMesh with_three_labels(std::vector<MeshLabel> labels) {
  TetMesh mesh = kuhn_mesh(3);
  mesh.header.labels = std::move(labels);
  mesh.regions = ByteBuffer(mesh.header.tet_count * sizeof(LabelNumber));
  for (std::uint64_t tet = 0; tet < mesh.header.tet_count; ++tet) {
    const LabelNumber number = tet / 6 < 9 ? 0 : tet / 6 == 13 ? 1 : 2;
    std::memcpy(mesh.regions.bytes().data() + tet * sizeof(number), &number, sizeof(number));
  }
  return mesh;
}

TEST(FindFaces, NamesWhatLiesBetweenLabelsOnceAsTheLowerOnes) {
  const TetMesh mesh = with_faces(with_three_labels({{1, "bone"}, {5, ""}, {9, "skin"}}));
  EXPECT_EQ(labels_of(mesh), (std::map<std::string, int>{{"bone_surface", 42},
                                                         {"skin_surface", 66},
                                                         {"bone_label_5", 2},
                                                         {"bone_skin", 16},
                                                         {"label_5_skin", 10}}));
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const std::string& name = mesh.header.face_labels[mesh.face_label(i)].name;
    const LabelNumber owner = mesh.label(mesh.face_tet(i));
    EXPECT_EQ(owner, name.starts_with("bone") ? 0 : name.starts_with("label_5") ? 1 : 2);
  }
}

TEST(FindFaces, NamesNoTwoPairsAlike) {
  const TetMesh mesh = with_faces(with_three_labels({{1, "a"}, {5, "a"}, {9, "a_1_a"}}));
  std::set<std::string> names;
  for (const FaceLabel& label : mesh.header.face_labels) names.insert(label.name);
  EXPECT_EQ(names.size(), 5U);
}

TEST(FindFaces, LabelsFacesOfACutByTheFacesOfTheBoxThatTheirVerticesLieIn) {
  TetMesh mesh = with_fields(kuhn_mesh(2), {{"heat", 1}, {kCutFaceArray, 1}});
  for (std::uint64_t i = 0; i < mesh.header.vertex_count; ++i) {
    const auto [x, y, z] = mesh.vertex(i);
    const float faces = (x == 2 ? 2.0F : 0.0F) + (z == 0 ? 16.0F : 0.0F);
    std::memcpy(mesh.fields.bytes().data() + (2 * i + 1) * sizeof(float), &faces, sizeof faces);
  }
  add_faces(mesh);
  EXPECT_EQ(labels_of(mesh),
            (std::map<std::string, int>{{"surface", 32}, {"cut_x_max", 8}, {"cut_z_min", 8}}));
  EXPECT_EQ(mesh.header.face_labels[2].kind, FaceKind::kBox);
}

TEST(FindFaces, TakesAnyNumberInTheArrayOfACut) {
  // Not only those that are faces of a box: it may have come from anybody.
  TetMesh mesh = with_fields(kuhn_mesh(1), {{kCutFaceArray, 1}});
  for (const float hostile : {-1.0F, 64.0F, 3e9F, std::nanf("")}) {
    for (std::size_t i = 0; i < 8; ++i) {
      std::memcpy(mesh.fields.bytes().data() + i * sizeof(float), &hostile, sizeof hostile);
    }
    EXPECT_EQ(labels_of(with_faces(with_fields(kuhn_mesh(1), {}))),
              (std::map<std::string, int>{{"surface", 12}}));
    add_faces(mesh);
    EXPECT_EQ(labels_of(mesh), (std::map<std::string, int>{{"surface", 12}}));
  }
}

TEST(FindFaces, NamesThemByTheirPartsWhereThereAreSeveral) {
  TetMesh mesh = make_mesh(lattice_points(2), {{0, 9, 3, 1}, {13, 22, 16, 14}});
  mesh.header.parts = {{"femur", 0, 13, 0, 1, 1, 0}, {"tibia", 13, 14, 1, 1, 1, 0}};
  add_faces(mesh);
  EXPECT_EQ(labels_of(mesh),
            (std::map<std::string, int>{{"femur_surface", 4}, {"tibia_surface", 4}}));
  EXPECT_EQ(mesh.header.face_labels[1].part, 2U);
}

/// Every tet has another label than those beside it.
TetMesh with_a_label_each(TetMesh mesh) {
  constexpr std::uint64_t kLabels = 30;
  mesh.header.labels.resize(kLabels);
  mesh.regions = ByteBuffer(mesh.header.tet_count * sizeof(LabelNumber));
  for (std::uint64_t tet = 0; tet < mesh.header.tet_count; ++tet) {
    const auto number = static_cast<LabelNumber>(tet % kLabels);
    std::memcpy(mesh.regions.bytes().data() + tet * sizeof(number), &number, sizeof(number));
  }
  return mesh;
}

TEST(FaceSearch, SaysWhatItTakesOfMemoryByWhatMayBeAFace) {
  const TetMesh plain = kuhn_mesh(12), labelled = with_a_label_each(kuhn_mesh(12));
  const std::uint64_t tets = plain.header.tet_count, vertices = plain.header.vertex_count;
  const Cancellation never;
  EXPECT_LT(FaceSearch(plain, never).bytes(), FaceSearch::bytes_of(vertices, tets));
  EXPECT_EQ(FaceSearch(labelled, never).bytes(), FaceSearch::bytes_of(vertices, 4 * tets));
  EXPECT_GT(FaceSearch::bytes_of(vertices, 4 * tets), 16 * vertices + 40 * 4 * tets);
}

TEST(FaceSearch, LooksOftenWhetherItIsToStop) {
  const TetMesh mesh = with_a_label_each(kuhn_mesh(48));
  std::atomic<std::uint64_t> looks = 0;
  const Cancellation cancellation(Cancellation::Clock::time_point::max(), [&] {
    ++looks;
    return false;
  });
  const FoundFaces found = find_faces(mesh, cancellation);
  const std::uint64_t tets = mesh.header.tet_count;
  EXPECT_GT(found.faces.size(), 2 * tets);
  // Three times over the tets, and over what may be faces three times, and once over these.
  EXPECT_GE(looks, 3 * tets / 16384 + 3 * 4 * tets / 65536);
}

/// Whatever was done by then is let go of.
TEST(FaceSearch, StopsWherever) {
  const TetMesh mesh = with_a_label_each(kuhn_mesh(20));
  for (std::uint64_t most = 0; most < 40; ++most) {
    std::atomic<std::uint64_t> looks = 0;
    const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                    [&] { return ++looks > most; });
    const FoundFaces found = find_faces(mesh, cancellation);
    TetMesh with(mesh.header);
    set_faces(found, mesh, with);
    EXPECT_TRUE(cancellation.requested() || !found.faces.empty());
  }
}

TEST(CheckFaces, TakesTheFacesOfItsTetsAndNoOthers) {
  for (const auto ids : {IndexType::kUint32, IndexType::kUint64}) {
    const TetMesh right =
        with_faces(make_mesh(unit_corner(), {{0, 1, 2, 3}}, {.ids = ids, .origin = {}}));
    const ChunkExtent all = whole_of(right.header);
    EXPECT_TRUE(faces_are_of_tets(right.header, all, right.columns()));
    const auto spoilt = [&](ByteBuffer TetMesh::*column, std::size_t byte, int value) {
      TetMesh mesh = with_faces(make_mesh(unit_corner(), {{0, 1, 2, 3}}, {.ids = ids}));
      (mesh.*column).bytes()[byte] = static_cast<std::byte>(value);
      return faces_are_of_tets(mesh.header, all, std::as_const(mesh).columns());
    };
    EXPECT_FALSE(spoilt(&TetMesh::faces, 0, 0)) << "0, 2, 3 is not a face of the tet";
    EXPECT_FALSE(spoilt(&TetMesh::faces, 0, 77)) << "no vertex";
    EXPECT_FALSE(spoilt(&TetMesh::face_tets, 0, 1)) << "no tet";
    EXPECT_FALSE(spoilt(&TetMesh::face_labels, 2, 1)) << "no label";
    ChunkExtent later = all;
    later.first_tet = 1;
    EXPECT_FALSE(faces_are_of_tets(right.header, later, right.columns())) << "another's tet";
  }
}

TEST(CheckFaces, TakesNoFaceTwice) {
  TetMesh mesh = with_faces(one_tet());
  const std::size_t face = 3 * sizeof(std::uint32_t);
  std::ranges::copy(mesh.faces.bytes().first(face), mesh.faces.bytes().subspan(face).begin());
  EXPECT_FALSE(faces_are_of_tets(mesh.header, whole_of(mesh.header), mesh.columns()));
}

TEST(FindFaces, OfNothingAreNone) {
  const TetMesh mesh = with_faces(make_mesh({}, {}));
  EXPECT_EQ(mesh.header.face_count, 0U);
  EXPECT_TRUE(mesh.header.has_faces());
}

}  // namespace
}  // namespace tet
