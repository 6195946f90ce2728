// A mesh counted by many hosts is the mesh that one counts, whatever of their work arrives.
#include "core/plan/brick/divided_survey.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/plan/brick/survey_bytes.h"
#include "core/plan/make/fill_mesh.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::divided_survey_test {
namespace {

using ::testing::HasSubstr;

using Block = std::vector<std::byte>;

constexpr std::size_t kBlockBricks = 40;

struct Input {
  std::string name;
  std::shared_ptr<const Volume> volume;
  MeshRequest request = {};
};

std::vector<Input> inputs() {
  const auto shared = [](Volume volume) {
    return std::make_shared<const Volume>(std::move(volume));
  };
  MeshRequest fine;
  fine.spacing = 0.7;
  MeshRequest both;
  both.preset = Preset::kBothSides;
  return {
      {"ball", shared(test::ball(30)), test::with_levels(0)},
      {"graded ball", shared(test::ball(30))},
      {"gyroid", shared(test::gyroid_ball(56))},
      {"random signs", shared(test::random_signs(44, 7))},
      {"zeros", shared(test::random_signs(36, 8, 3)), test::with_levels(2)},
      {"plate", shared(test::plate({1, 20})), fine},
      {"both sides", shared(test::ball(20)), both},
      {"random domain", shared(test::random_signs(30, 9)), both},
  };
}

std::vector<Block> survey_all(const Input& input) {
  const auto blocks =
      count_survey_blocks(input.volume, input.request, {}, kBlockBricks, Cancellation());
  EXPECT_TRUE(blocks.ok()) << blocks.status();
  std::vector<Block> all;
  for (std::size_t i = 0; blocks.ok() && i < *blocks; ++i) {
    auto block = survey_block(input.volume, input.request, {}, kBlockBricks, i, Cancellation());
    EXPECT_TRUE(block.ok()) << block.status();
    all.push_back(block.ok() ? *std::move(block) : Block());
  }
  return all;
}

SurveyedBlocks found_among(const std::vector<std::optional<Block>>& blocks) {
  return {kBlockBricks, [blocks](std::size_t i) { return blocks[i]; }};
}

std::shared_ptr<const MeshPlan> plan(const Input& input, const SurveyedBlocks& surveyed = {}) {
  auto made =
      plan_mesh({.shape = input.volume, .request = input.request, .surveyed = surveyed});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : nullptr;
}

TEST(DividedSurvey, MakesTheMeshThatOneHostMakes) {
  for (const Input& input : test::few_of(inputs(), 4)) {
    SCOPED_TRACE(input.name);
    const std::vector<Block> blocks = survey_all(input);
    ASSERT_GT(blocks.size(), 2U);
    const auto joined = plan(input, found_among({blocks.begin(), blocks.end()}));
    const auto whole = plan(input);
    ASSERT_TRUE(joined && whole);
    test::expect_same_plans(*joined, *whole);
  }
}

TEST(DividedSurvey, SurveysWhatDoesNotArrive) {
  const std::vector<Input> all = inputs();
  for (const std::size_t of : test::few_of(std::vector<std::size_t>{7, 3}, 1)) {
    const Input& input = all[of];
    SCOPED_TRACE(input.name);
    const std::vector<Block> blocks = survey_all(input);
    std::vector<std::optional<Block>> arrived(blocks.begin(), blocks.end());
    for (std::size_t i = 0; i < arrived.size(); i += 2) arrived[i] = std::nullopt;
    const auto joined = plan(input, found_among(arrived));
    const auto whole = plan(input);
    ASSERT_TRUE(joined && whole);
    test::expect_same_plans(*joined, *whole);
  }
}

// What is not counted has rows all the same: whoever looks one up by its brick finds its own.
TEST(DividedSurvey, HasARowForEveryBrickWithoutStatistics) {
  Input input = inputs()[3];
  const std::vector<Block> blocks = survey_all(input);
  std::vector<std::optional<Block>> arrived(blocks.begin(), blocks.end());
  for (std::size_t i = 0; i < arrived.size(); i += 2) arrived[i] = std::nullopt;
  input.request.skip_statistics = true;
  const auto prepared = prepare_mesh(input.volume, input.request, {}, Cancellation());
  ASSERT_TRUE(prepared.ok());
  const auto survey = join_survey(*prepared, found_among(arrived), Cancellation(), nullptr);
  ASSERT_TRUE(survey.ok());
  EXPECT_FALSE(survey->has_topology);
  EXPECT_EQ(survey->counts.size(), survey->bricks.size());
  EXPECT_EQ(survey->sheets.size(), survey->bricks.size());
  EXPECT_TRUE(survey->parts.empty());
}

TEST(DividedSurvey, MakesTheSameBytesOfABlockAnywhere) {
  const Input input = inputs()[2];
  const std::vector<Block> first = survey_all(input);
  std::vector<Block> second;
  TaskPool pool(5);
  pool.run([&] { second = survey_all(input); });
  EXPECT_EQ(first, second);
}

TEST(DividedSurvey, TakesNoBlockOfAnotherPlace) {
  const Input gyroid = inputs()[2];
  std::vector<Block> swapped = survey_all(gyroid);
  std::swap(swapped[0], swapped[1]);
  const auto joined = plan(gyroid, found_among({swapped.begin(), swapped.end()}));
  const auto whole = plan(gyroid);
  ASSERT_TRUE(joined && whole);
  test::expect_same_plans(*joined, *whole);
}

TEST(DividedSurvey, RefusesEveryTruncation) {
  for (const bool both_sides : {false, true}) {
    const Input input = inputs()[both_sides ? 7 : 3];
    const auto prepared = prepare_mesh(input.volume, input.request, {}, Cancellation());
    ASSERT_TRUE(prepared.ok());
    std::vector<BrickCoord> bricks = prepared->bricks.near_surface;
    bricks.resize(5);
    const auto survey =
        survey_bricks(prepared->field, bricks, prepared->space, Cancellation(), nullptr);
    ASSERT_TRUE(survey.ok());
    const Block bytes = write_survey(*survey, bricks);
    ASSERT_TRUE(read_survey(bytes, bricks, both_sides));
    EXPECT_FALSE(read_survey(bytes, bricks, !both_sides));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_FALSE(read_survey(std::span(bytes).first(size), bricks, both_sides)) << size;
    }
  }
}

TEST(DividedSurvey, SurvivesEveryChangedByte) {
  const Input input = inputs()[3];
  const auto prepared = prepare_mesh(input.volume, input.request, {}, Cancellation());
  ASSERT_TRUE(prepared.ok());
  std::vector<BrickCoord> bricks = prepared->bricks.near_surface;
  bricks.resize(4);
  const auto survey =
      survey_bricks(prepared->field, bricks, prepared->space, Cancellation(), nullptr);
  ASSERT_TRUE(survey.ok());
  Block bytes = write_survey(*survey, bricks);
  for (std::byte& byte : bytes) {
    const std::byte was = byte;
    for (const std::byte flip : {std::byte{1}, std::byte{0x80}, std::byte{0xff}}) {
      byte = was ^ flip;
      const auto read = read_survey(bytes, bricks, false);
      if (!read) continue;
      EXPECT_EQ(read->bricks.size(), read->stuffed.size());
      for (const PartsOfBrick& parts : read->parts) {
        EXPECT_LT(parts.brick, read->bricks.size());
        EXPECT_EQ(parts.parts->beside.size(), parts.parts->count);
      }
    }
    byte = was;
  }
}

// Blocks tell of a surface's parts, whoever puts them together.
TEST(DividedSurvey, KeepsNothingOfTopologyWhereNobodyAsks) {
  const auto blobs = [](VoxelCoord v) {
    return v.x % 2 == 0 && v.y % 2 == 0 && v.z % 2 == 0 ? -1.0F : 1.0F;
  };
  Input input{"blobs", std::make_shared<const Volume>(
                           test::dense_volume({{0, 0, 0}, {63, 63, 63}}, 1, blobs))};
  input.request.skip_statistics = true;
  const std::vector<Block> blocks = survey_all(input);
  // Too few bytes for the parts.
  const MeshLimits limits{.max_plan_bytes = 2'600'000};
  for (const auto& surveyed : {found_among({blocks.begin(), blocks.end()}), SurveyedBlocks()}) {
    const auto made = plan_mesh({.shape = input.volume,
                                 .request = input.request,
                                 .limits = limits,
                                 .surveyed = surveyed});
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_FALSE((*made)->boundary());
  }
}

TEST(DividedSurvey, LeavesManifoldsToOneHost) {
  Input input = inputs()[3];
  input.request.manifold = true;
  const auto blocks =
      count_survey_blocks(input.volume, input.request, {}, kBlockBricks, Cancellation());
  ASSERT_TRUE(blocks.ok());
  EXPECT_EQ(*blocks, 1U);
  const auto block =
      survey_block(input.volume, input.request, {}, kBlockBricks, 0, Cancellation());
  EXPECT_EQ(block.status().code(), absl::StatusCode::kInvalidArgument);
  const auto alone = plan(input, {kBlockBricks, [](std::size_t) -> std::optional<Block> {
                                    ADD_FAILURE() << "asked for a block";
                                    return std::nullopt;
                                  }});
  ASSERT_TRUE(alone);
}

TEST(DividedSurvey, NamesTheBlockThatThereIsNot) {
  const Input input = inputs()[0];
  const auto block =
      survey_block(input.volume, input.request, {}, kBlockBricks, 1000, Cancellation());
  EXPECT_EQ(block.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(block.status().message()), HasSubstr("block 1000 of a survey of"));
}

TEST(DividedSurvey, StopsWhenItIsCancelled) {
  const Input input = inputs()[2];
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_EQ(
      survey_block(input.volume, input.request, {}, kBlockBricks, 0, cancelled).status().code(),
      absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace tet::divided_survey_test
