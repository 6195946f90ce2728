// Every promise of a mesh, on random fields of every family, with every preset.
#include <string>

#include <gtest/gtest.h>

#include "tests/support/mesh_promises.h"
#include "tests/support/random_fields.h"

namespace tet {
namespace {

class HostileFields : public testing::TestWithParam<std::string_view> {};

TEST_P(HostileFields, AreMeshedAsPromised) {
  TaskPool pool(2);
  std::uint64_t tets = 0;
  constexpr std::uint64_t kEnough = 3'000'000;
  for (std::uint32_t seed = 1; tets < kEnough; ++seed) {
    for (const Preset preset : kPresets) {
      test::FieldCase given{std::string(GetParam()), seed, 48, preset};
      // Every third field on a lattice of its own.
      if (seed % 3 == 0) given.spacing = seed % 2 == 0 ? 0.7 : 1.4;
      const test::Outcome outcome = test::check_promises(given, pool);
      ASSERT_EQ(outcome.violation, "") << "field_trial --fields 1 " << arguments_of(given);
      tets += outcome.tets;
    }
    ASSERT_LT(seed, 200U) << "fields too small";
  }
}

INSTANTIATE_TEST_SUITE_P(Fields,
                         HostileFields,
                         testing::ValuesIn(test::field_families().begin(),
                                           test::field_families().end()),
                         [](const auto& family) { return std::string(family.param); });

}  // namespace
}  // namespace tet
