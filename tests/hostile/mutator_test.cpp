#include "tests/hostile/mutator.h"

#include <set>
#include <span>
#include <sstream>

#include <gtest/gtest.h>

#include "core/vdb/walk/walk_vdb.h"
#include "tests/hostile/campaign.h"
#include "tests/hostile/seed_files.h"

namespace tet::test {
namespace {

absl::Status walk(const Mutant& mutant) {
  return walk_vdb(ByteSource(std::as_bytes(std::span(mutant.bytes)))).status();
}

TEST(Mutator, MakesTheSameMutantsOfTheSameNumbers) {
  const Mutator one(seed_files(), 7), other(seed_files(), 7), third(seed_files(), 8);
  std::size_t different = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    EXPECT_EQ(one.mutant(i).bytes, other.mutant(i).bytes) << one.mutant(i).description;
    EXPECT_EQ(one.mutant(i).description, other.mutant(i).description);
    different += one.mutant(i).bytes != third.mutant(i).bytes ? 1U : 0U;
  }
  EXPECT_GT(different, 190U);
}

TEST(Mutator, LiesInEveryFieldThatTheWalkerKnows) {
  std::set<std::string> names;
  const std::vector<SeedFile> seeds = seed_files();
  for (const SeedFile& seed : seeds) {
    for (const auto& [name, fields] : seed.named) names.insert(std::string(name));
  }
  const Mutator mutator(seeds, 1);
  for (std::uint64_t i = 0; i < 20'000 && !names.empty(); ++i) {
    const std::string description = mutator.mutant(i).description;
    std::erase_if(names, [&](const std::string& name) {
      return description.find(" " + name + "@") != std::string::npos;
    });
  }
  EXPECT_TRUE(names.empty()) << *names.begin();
}

TEST(Campaign, FindsNothingThatHarmsTheWalker) {
  const Mutator mutator(seed_files(), 20261121);
  std::ostringstream log;
  const CampaignResult result = run_campaign(
      mutator, {0, 4000}, {walk, processor_seconds}, [](std::uint64_t, const Mutant&) {}, log);
  EXPECT_EQ(result.unexpected, 0U) << log.str();
  EXPECT_LT(result.slowest_seconds, 2) << "mutant " << result.slowest;
  EXPECT_GT(result.outcomes.at(absl::StatusCode::kInvalidArgument), 2000U);
  EXPECT_GT(result.accepted_changed, 100U) << "some must pass, or nothing behind is tried";
}

}  // namespace
}  // namespace tet::test
