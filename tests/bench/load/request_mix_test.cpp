#include "bench/load/request_mix.h"

#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/load/mix_options.h"
#include "tests/server/test_folder.h"

namespace tet::load {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

MixEntry entry_of(const std::string& label, double weight) {
  MixEntry entry;
  entry.label = label;
  entry.weight = weight;
  entry.message.set_grid_name(label);
  return entry;
}

TEST(RequestMix, DrawsByWeight) {
  RequestMix mix({entry_of("often", 3), entry_of("seldom", 1)});
  std::mt19937_64 random(1);
  int often = 0;
  for (int i = 0; i < 10000; ++i) {
    const RequestMix::Drawn drawn = mix.draw(random);
    EXPECT_EQ(drawn.message.grid_name(), drawn.entry == 0 ? "often" : "seldom");
    often += drawn.entry == 0 ? 1 : 0;
  }
  EXPECT_NEAR(often, 7500, 180);  // four deviations
}

TEST(RequestMix, DrawsTheSameFromTheSameSeed) {
  const auto draw = [](std::uint64_t seed) {
    MixEntry entry = entry_of("ball", 1);
    entry.iso = {-1, 1};
    RequestMix mix({entry, entry_of("torus", 1)});
    std::mt19937_64 random(seed);
    std::vector<std::string> drawn;
    for (int i = 0; i < 20; ++i) drawn.push_back(mix.draw(random).message.SerializeAsString());
    return drawn;
  };
  EXPECT_TRUE(draw(4) == draw(4));
  EXPECT_FALSE(draw(4) == draw(5));
}

TEST(RequestMix, VariesTheIsoValueWithinItsRange) {
  MixEntry entry = entry_of("smoke", 1);
  entry.iso = {0.2, 0.4};
  RequestMix mix({entry});
  std::mt19937_64 random(1);
  double low = 1, high = 0;
  for (int i = 0; i < 1000; ++i) {
    const double iso = mix.draw(random).message.iso();
    low = std::min(low, iso);
    high = std::max(high, iso);
  }
  EXPECT_NEAR(low, 0.2, 0.002);
  EXPECT_NEAR(high, 0.4, 0.002);
}

TEST(RequestMix, AsksForAnotherMeshEachTimeWhenFresh) {
  MixEntry entry = entry_of("ball", 1);
  entry.fresh = true;
  entry.message.set_spacing(0.1);
  RequestMix mix({entry});
  std::mt19937_64 random(1);
  std::map<double, int> spacings;
  for (int i = 0; i < 1000; ++i) ++spacings[mix.draw(random).message.spacing()];
  EXPECT_EQ(spacings.size(), 1000u);
  EXPECT_NEAR(spacings.rbegin()->first, 0.1, 1e-9);
}

TEST(RequestMix, SharesNoFreshMeshWithAnotherRun) {
  constexpr std::uint64_t kLast = (1 << 30) - 1;
  EXPECT_LE(draw_fresh_from(), kLast);
  std::set<std::uint64_t> drawn;
  for (int i = 0; i < 8; ++i) drawn.insert(draw_fresh_from());
  EXPECT_GT(drawn.size(), 1u);
  for (const double spacing : {0.1, 0.5, 0.999, 1.0, 1.001, 3.0}) {
    std::map<double, int> spacings;
    for (const std::uint64_t fresh_from : {std::uint64_t{0}, std::uint64_t{1000}, kLast}) {
      MixEntry entry = entry_of("ball", 1);
      entry.fresh = true;
      entry.fresh_from = fresh_from;
      entry.message.set_spacing(spacing);
      RequestMix mix({entry});
      std::mt19937_64 random(1);
      for (int i = 0; i < 1000; ++i) ++spacings[mix.draw(random).message.spacing()];
    }
    EXPECT_EQ(spacings.size(), 3000u) << spacing;
    EXPECT_NEAR(spacings.rbegin()->first, spacing, 1.1e-6 * spacing);
  }
}

class MixFile : public testing::Test {
 protected:
  std::string write(const std::string& text) { return folder_.write("mix.txt", text); }
  test::TestFolder folder_;
};

TEST_F(MixFile, HasTheOptionsOfTheMeshCommand) {
  const auto mix =
      read_mix_file(write("# a comment\n"
                          "\n"
                          "--weight 3 bunny.vdb --levels 0 --spacing 0.5\n"
                          "  \"my smoke.vdb\" --grid density --vary-iso 0.1 0.2\n"));
  ASSERT_TRUE(mix.ok()) << mix.status();
  ASSERT_EQ(mix->size(), 2u);
  EXPECT_EQ((*mix)[0].weight, 3);
  EXPECT_THAT((*mix)[0].grids, ElementsAre("bunny.vdb"));
  EXPECT_EQ((*mix)[0].request.levels, 0);
  EXPECT_EQ((*mix)[0].request.request.spacing, 0.5);
  EXPECT_THAT((*mix)[1].grids, ElementsAre("my smoke.vdb"));
  EXPECT_EQ((*mix)[1].request.grids, std::vector<std::string>{"density"});
  EXPECT_EQ((*mix)[1].vary_iso->at(1), 0.2);
}

TEST_F(MixFile, NamesTheLineThatIsWrong) {
  for (const std::string wrong : {"--levels 0", "a.vdb --level 0", "a.vdb --weight 0",
                                  "a.vdb --iso 1 --vary-iso 0 1", "a.vdb --levels x"}) {
    const auto mix = read_mix_file(write("a.vdb\n" + wrong + "\n"));
    ASSERT_FALSE(mix.ok()) << wrong;
    EXPECT_THAT(std::string(mix.status().message()), HasSubstr("mix.txt:2: "));
  }
}

TEST_F(MixFile, MustExistAndHaveARequest) {
  EXPECT_TRUE(absl::IsNotFound(read_mix_file(folder_.file("none")).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(read_mix_file(write("# nothing\n")).status()));
}

}  // namespace
}  // namespace tet::load
