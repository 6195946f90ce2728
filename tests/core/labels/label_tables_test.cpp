// The tables of three and four labels: they fill their tet, and divide its faces as told.
#include "core/labels/label_tables.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/labels/label_tets.h"
#include "core/labels/lattice_faces.h"

namespace tet {
namespace {

std::int64_t six_volumes(const LabelTetCorners& tet) {
  const auto at = [&](std::size_t i) { return internal::label_reference(tet[i]); };
  return internal::triple_product(at(1) - at(0), at(2) - at(0), at(3) - at(0));
}
constexpr std::int64_t kWhole = 12 * 12 * 12;

using Triangle = std::array<LabelCorner, 3>;

/// Faces of tets by their sorted corners, and how often each is there.
template <class Tets>
void count_faces(const Tets& tets, std::map<Triangle, int>& faces) {
  for (std::size_t t = 0; t < tets.count; ++t) {
    for (std::size_t skip = 0; skip < 4; ++skip) {
      Triangle face{};
      std::size_t next = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        if (i != skip) face[next++] = tets.tet[t][i];
      }
      std::ranges::sort(face);
      ++faces[face];
    }
  }
}

/// What of a whole division is open: the triangles of the tet's faces.
std::set<Triangle> open_faces(const std::map<Triangle, int>& faces) {
  std::set<Triangle> open;
  for (const auto& [face, count] : faces) {
    EXPECT_LE(count, 2);
    if (count == 1) open.insert(face);
  }
  return open;
}

/// A face of three labels, in the names of its tet.
void add_triple_face(std::size_t face, std::set<Triangle>& triangles) {
  const auto nodes = nodes_of_face(face);
  for (const std::uint8_t from : nodes) {
    for (const std::uint8_t to : nodes) {
      if (from == to) continue;
      Triangle triangle{from, label_cut(from, to), label_triple(face)};
      std::ranges::sort(triangle);
      triangles.insert(triangle);
    }
  }
}

TEST(LabelTables, FourLabelsFillTheTetAndDivideItsFacesAtTheirTriplePoints) {
  std::map<Triangle, int> faces;
  std::int64_t volume = 0;
  for (const LabelTetCorners& tet : kFourLabels.tet) {
    EXPECT_GT(six_volumes(tet), 0);
    volume += six_volumes(tet);
  }
  EXPECT_EQ(volume, kWhole);
  count_faces(kFourLabels, faces);
  std::set<Triangle> expected;
  for (std::size_t face = 0; face < 4; ++face) add_triple_face(face, expected);
  EXPECT_EQ(open_faces(faces), expected);
}

TEST(LabelTables, AJokersConeFillsTheTet) {
  for (const auto& cone : kJokerCones) {
    std::int64_t volume = 0;
    for (const LabelTetCorners& tet : cone.tet) {
      EXPECT_GT(six_volumes(tet), 0);
      volume += six_volumes(tet);
    }
    EXPECT_EQ(volume, kWhole);
  }
}

std::set<Triangle> faces_of_three_labels(bool second_starts_at_b, bool second_starts_at_c) {
  std::set<Triangle> triangles;
  add_triple_face(0, triangles);
  add_triple_face(1, triangles);
  for (const auto& [other, second] :
       {std::pair<std::uint8_t, bool>{2, second_starts_at_b}, {3, second_starts_at_c}}) {
    const std::uint8_t longer = second ? 1 : 0, shorter = second ? 0 : 1;
    for (Triangle triangle :
         {Triangle{other, label_cut(other, 0), label_cut(other, 1)},
          Triangle{longer, shorter, label_cut(shorter, other)},
          Triangle{longer, label_cut(shorter, other), label_cut(longer, other)}}) {
      std::ranges::sort(triangle);
      triangles.insert(triangle);
    }
  }
  return triangles;
}

TEST(LabelTables, ThreeLabelsFillTheTetWhateverIsChosenAndDivideItsFacesAlike) {
  for (std::size_t choice = 0; choice < 4; ++choice) {
    const bool at_b = (choice & 1) != 0, at_c = (choice & 2) != 0;
    const std::set<Triangle> expected = faces_of_three_labels(at_b, at_c);
    const auto& fan = kLabelFans[at_b][at_c];
    std::map<Triangle, int> faces;
    std::int64_t volume = 0;
    for (const LabelTetCorners& tet : fan.tet) volume += six_volumes(tet);
    EXPECT_EQ(volume, kWhole);
    count_faces(fan, faces);
    EXPECT_EQ(open_faces(faces), expected);
    int divisions = 0;
    for (std::size_t bits = 0; bits < 8; ++bits) {
      const std::size_t shared = bits & 1, d_b = bits >> 1 & 1, d_c = bits >> 2;
      const auto& half_b = kLabelHalves[0][at_b][shared][d_b];
      const auto& half_c = kLabelHalves[1][at_c][shared][d_c];
      if (half_b.count == 0 || half_c.count == 0) continue;  // cyclic
      ++divisions;
      faces.clear();
      for (const auto* part : {&half_b, &half_c, &kLabelParts[0][d_b], &kLabelParts[1][d_c]}) {
        EXPECT_EQ(part->count, 3U);
        for (const LabelTetCorners& tet : part->tet) EXPECT_GT(six_volumes(tet), 0);
        count_faces(*part, faces);
      }
      EXPECT_EQ(open_faces(faces), expected);
    }
    EXPECT_GE(divisions, 4);
  }
}

TEST(LabelTables, EveryFaceOfTheLatticeIsSharedByTwoTetsOfDifferentPlaces) {
  std::array<int, kFaceFamilies> tets{};
  for (const auto& faces : kFaceOfShape) {
    for (const std::uint8_t family : faces) ++tets[family];
  }
  for (const int count : tets) EXPECT_EQ(count, 2);
}

TEST(LabelTets, TheMostVotesWinAndThenTheHighestLabel) {
  EXPECT_EQ(elected({{{1, 2}, {1, 2}, {1, 2}, {1, 2}}}), 2);
  EXPECT_EQ(elected({{{1, 2}, {1, 2}, {1, 1}, {1, 2}}}), 1);
  EXPECT_EQ(elected({{{7, 2}, {3, 7}, {5, 6}, {4, 8}}}), 7);
  EXPECT_EQ(elected({{{1, 2}, {3, 4}, {5, 6}, {7, 8}}}), 8);
}

}  // namespace
}  // namespace tet
