// Random surfaces on demand: converts COUNT of them from SEED on, and says how many of the
// volumes are right, warned of or refused. Fails when one is wrong without a word.
//   surface_campaign [COUNT [SEED]]
#include <cstdio>
#include <cstdlib>

#include "tests/core/vdb/surface_trial.h"

int main(int argc, char** argv) {
  const auto number = [&](int i, std::uint64_t unless) {
    return argc > i ? std::strtoull(argv[i], nullptr, 10) : unless;
  };
  const std::uint64_t count = number(1, 1000), first = number(2, 0);
  std::uint64_t silent = 0, warned = 0, refused = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const tet::test::SurfaceTrial trial = tet::test::trial_of_surface(seed);
    if (!trial.silent.empty()) std::printf("silent: %s\n", trial.silent.c_str());
    if (trial.refused) std::printf("refused: %s\n", trial.what.c_str());
    silent += trial.silent.empty() ? 0 : 1;
    warned += trial.warned ? 1 : 0;
    refused += trial.refused ? 1 : 0;
  }
  std::printf("%lu surfaces: %lu right, %lu warned of, %lu refused, %lu wrong without a word\n",
              count, count - silent - warned - refused, warned, refused, silent);
  return silent == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
