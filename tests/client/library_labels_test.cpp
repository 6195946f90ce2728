// Segmentations by the public library, here and beside a real server.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "client/library/api/labels_impl.h"
#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::collected;
using test::expect_same;
using test::LibraryOnAServer;
using testing::ElementsAre;
using testing::HasSubstr;

/// Marrow (7) within bone (4), and a cap (1000) on top.
struct BoneVoxels {
  static constexpr std::size_t kEdge = 20;

  BoneVoxels() {
    for (std::size_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const double x = at(i / kEdge / kEdge), y = at(i / kEdge % kEdge), z = at(i % kEdge);
      const double r = std::hypot(x, y, z);
      values.push_back(static_cast<std::int16_t>(r > 8 ? 0 : z > 4 ? 1000 : r <= 4 ? 7 : 4));
    }
  }
  static double at(std::size_t i) { return static_cast<double>(i) - 9.5; }

  LabelArray array() const {
    return {.values = std::span<const std::int16_t>(values),
            .size = {kEdge, kEdge, kEdge},
            .origin = {-9.5, -9.5, -9.5}};
  }
  Labels labels() const { return Labels::from_voxels(array()).value(); }

  std::vector<std::int16_t> values;
};

std::vector<std::int64_t> values_of(const std::vector<MeshLabel>& labels) {
  std::vector<std::int64_t> values;
  for (const MeshLabel& label : labels) values.push_back(label.value);
  return values;
}

double volume_of(const Mesh& mesh, std::size_t number) {
  double six = 0;
  for (std::size_t i = 0; i < mesh.tet_count(); ++i) {
    if (mesh.columns().labels[i] != number) continue;
    const auto ids = mesh.tet(i);
    const Point a = mesh.vertex(ids[0]);
    std::array<Point, 3> edge{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Point b = mesh.vertex(ids[k + 1]);
      edge[k] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    }
    const auto& [u, v, w] = edge;
    six += u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
  }
  return six / 6;
}

TEST(LibraryLabels, MeshEveryLabelOfAnArray) {
  const Labels labels = BoneVoxels().labels();
  const Mesh made = mesh(labels).value();
  EXPECT_THAT(values_of(made.header().labels), ElementsAre(4, 7, 1000));
  ASSERT_EQ(made.columns().labels.size(), made.tet_count());
  EXPECT_TRUE(made.columns().regions.empty());
  std::map<std::int64_t, double> voxels;
  for (const LabelCount& count : labels.counts()) {
    voxels[count.value] = static_cast<double>(count.voxels);
  }
  ASSERT_EQ(voxels.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) {
    const double expected = voxels.at(made.header().labels[i].value);
    EXPECT_NEAR(volume_of(made, i), expected, 0.1 * expected);
  }
  EXPECT_GT(made.statistics().quality->min_dihedral_deg, 9.3);
  EXPECT_LT(made.statistics().quality->max_dihedral_deg, 157.6);
}

TEST(LibraryLabels, AreChosenMergedAndNamed) {
  const Labels labels = BoneVoxels().labels();
  Request request{.faces = true};
  request.labels = {.only = {{4, 10}}, .names = {{4, "bone"}, {7, "marrow"}}};
  const Mesh both = mesh(labels, request).value();
  EXPECT_THAT(values_of(both.header().labels), ElementsAre(4, 7));
  EXPECT_EQ(both.header().labels[1].name, "marrow");
  std::set<std::string> names;
  for (const FaceLabel& label : both.header().face_labels) names.insert(label.name);
  EXPECT_THAT(names, testing::IsSupersetOf({"bone_surface", "bone_marrow"}));
  request.labels->merges = {{{4, 4}, {7, 7}}};
  const Mesh merged = mesh(labels, request).value();
  EXPECT_THAT(values_of(merged.header().labels), ElementsAre(4));
  request.labels = {.mesh_background = true, .smoothing = LabelSmoothing::kNone};
  EXPECT_THAT(values_of(mesh(labels, request).value().header().labels),
              testing::UnorderedElementsAre(0, 4, 7, 1000));
}

TEST(LibraryLabels, TakeVoxelsOfAnyType) {
  const BoneVoxels bone;
  const Mesh expected = mesh(bone.labels()).value();
  const auto same = [&]<class T>(T) {
    const std::vector<T> values(bone.values.begin(), bone.values.end());
    LabelArray array = bone.array();
    array.values = std::span<const T>(values);
    expect_same(mesh(Labels::from_voxels(array).value()).value(), expected);
  };
  same(std::uint16_t{});
  same(std::uint32_t{});
  same(std::int64_t{});
  same(std::uint64_t{});
}

TEST(LibraryLabels, LieWhereTheirStepsSay) {
  const BoneVoxels bone;
  LabelArray array = bone.array();
  const double c = std::cos(0.5), s = std::sin(0.5);
  array.steps = {{{0.5 * c, 0.5 * s, 0}, {-0.5 * s, 0.5 * c, 0}, {0, 0, 1.5}}};
  array.origin = {100, 0, 0};
  const Labels labels = Labels::from_voxels(array).value();
  EXPECT_THAT(labels.voxel_edges(), ElementsAre(testing::DoubleNear(0.5, 1e-12),
                                                testing::DoubleNear(0.5, 1e-12), 1.5));
  const Mesh made = mesh(labels).value();
  const double expected = 0.375 * 4 / 3 * 3.14159265 * 64;  // the marrow is a ball of 4 voxels
  EXPECT_NEAR(volume_of(made, 1), expected, 0.1 * expected);
}

TEST(LibraryLabels, SayWhatIsWrongWithAnArray) {
  const std::vector<std::uint64_t> values{1, 2, 1ULL << 63, 0};
  const auto message = [&](const LabelArray& array) {
    const auto labels = Labels::from_voxels(array);
    EXPECT_FALSE(labels.ok());
    return labels.status().message();
  };
  const LabelValues stored = std::span<const std::uint64_t>(values);
  EXPECT_EQ(message({.values = stored, .size = {2, 2, 2}}),
            "size 2 x 2 x 2 does not agree with 4 labels");
  EXPECT_EQ(message({.values = stored, .size = {4, 1, 1}}),
            "voxel (2, 0, 0) has the label 9223372036854775808; the limit is "
            "9223372036854775807");
  EXPECT_THAT(
      message(
          {.values = stored, .size = {2, 2, 1}, .steps = {{{1, 0, 0}, {2, 0, 0}, {0, 0, 1}}}}),
      HasSubstr("voxels"));
  EXPECT_THAT(message({.values = stored, .size = {2, 2, 1}, .origin = {0, NAN, 0}}),
              HasSubstr("nan"));
  EXPECT_FALSE(Labels::from_voxels({}).ok());
}

TEST(LibraryLabels, AreTheSameFromAnImageThatWasWritten) {
  const tet::test::TestFolder folder;
  LabelArray array = BoneVoxels().array();
  const BoneVoxels bone;
  array.values = std::span<const std::int16_t>(bone.values);
  array.steps = {{{0.1, 0.2, 0}, {-0.2, 0.1, 0}, {0, 0, 1.0 / 3}}};
  const Labels labels = Labels::from_voxels(array).value();
  ASSERT_TRUE(labels.write_nrrd(folder.file("bone.nrrd")).ok());
  const auto read = Labels::from_file(folder.file("bone.nrrd"));
  const auto trusted = Labels::from_file(folder.file("bone.nrrd"), {.trusted = true});
  ASSERT_TRUE(read.ok() && trusted.ok()) << read.status().to_string();
  EXPECT_EQ(read->impl().volume->values, labels.impl().volume->values);
  expect_same(mesh(*read).value(), mesh(labels).value());
  expect_same(mesh(*trusted).value(), mesh(labels).value());
}

TEST(LibraryLabels, KeepLargeAndNegativeValuesInAnImage) {
  const tet::test::TestFolder folder;
  for (const std::vector<std::int64_t>& values :
       {std::vector<std::int64_t>{0, 255}, {0, 256}, {-1, 70'000}, {-5'000'000'000, 3}}) {
    LabelArray array{.values = std::span<const std::int64_t>(values), .size = {2, 1, 1}};
    const Labels labels = Labels::from_voxels(array).value();
    ASSERT_TRUE(labels.write_nrrd(folder.file("few.nrrd")).ok());
    const Labels read = Labels::from_file(folder.file("few.nrrd"), {.trusted = true}).value();
    EXPECT_EQ(read.impl().volume->labels, values);
  }
}

TEST(LibraryLabels, AreStreamedAndCounted) {
  const Labels labels = BoneVoxels().labels();
  const Request request{.spacing = 0.5};
  const Mesh whole = mesh(labels, request).value();
  const auto chunks = collected(stream(labels, request));
  expect_same(chunks, whole);
  EXPECT_EQ(values_of(chunks.header.labels), values_of(whole.header().labels));
  EXPECT_EQ(estimate(labels, request).value().tet_count, whole.tet_count());
}

TEST(LibraryLabels, AreNotAskedForOfAVolume) {
  Request request;
  request.labels.emplace();
  const auto refused = mesh(test::BallSamples(8).volume(), request);
  EXPECT_EQ(refused.status().code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(refused.status().message(), HasSubstr("labels"));
  const auto smooth = mesh(BoneVoxels().labels(), {.labels = LabelChoice{.smooth = 9}});
  EXPECT_EQ(smooth.status().message(), "labels.smooth 9 is not from 0 to 4 voxels");
}

TEST(LibraryLabels, TakeTheirNamesFromATable) {
  const tet::test::TestFolder folder;
  std::ofstream(folder.file("names.txt")) << "7 255 0 0 1 1 1 \"red marrow\"\n";
  std::ofstream(folder.file("wrong.txt")) << "marrow\n";
  const auto names = read_label_names(folder.file("names.txt")).value();
  ASSERT_EQ(names.size(), 1U);
  EXPECT_EQ(names[0].name, "red marrow");
  EXPECT_THAT(read_label_names(folder.file("wrong.txt")).status().message(),
              HasSubstr("wrong.txt: line 1"));
  EXPECT_EQ(read_label_names(folder.file("none.txt")).status().code(), StatusCode::kNotFound);
}

class ServedLabels : public LibraryOnAServer {};

TEST_F(ServedLabels, HaveTheSameBytesHereAndThere) {
  const Labels labels = BoneVoxels().labels();
  const StoredVolume stored = client().upload(labels).value();
  EXPECT_EQ(client().upload(labels).value().name, stored.name);
  Request all;
  all.labels.emplace();
  Request some{.spacing = 1.5, .levels = 3, .faces = true};
  some.labels = {.only = {{4, 7}},
                 .mesh_background = true,
                 .names = {{4, "bone"}},
                 .smoothing = LabelSmoothing::kThin};
  for (const Request& request : {all, some}) {
    const Mesh here = mesh(labels, request).value();
    for (const Encoding encoding : {Encoding::kPlain, Encoding::kPacked}) {
      StreamOptions options;
      options.encoding = encoding;
      const auto there = client().mesh(stored, request, options);
      ASSERT_TRUE(there.ok()) << there.status().to_string();
      expect_same(*there, here);
      EXPECT_EQ(values_of(there->header().labels), values_of(here.header().labels));
      expect_same(collected(client().stream(stored, request, options)), here);
    }
    EXPECT_EQ(client().estimate(stored, request).value().tet_count, here.tet_count());
  }
}

}  // namespace
}  // namespace tetstream
