// What plans look to cost beside what they cost: the worst requests of every kind.
//
//   cost_trial [--size S] [--most F] [--most-gap MS] [--only TEXT]
//
// Prints a line for each: its price in milliseconds of a processor, what it took of one, how
// often the price goes into that, and the most that it did between two looks at whether it is
// cancelled. Fails with exit code 1 where a price is wrong by more than F, or a gap is longer
// than MS.
#include <algorithm>
#include <iostream>

#include <CLI/CLI.hpp>
#include <absl/strings/match.h>
#include <absl/strings/str_format.h>

#include "tests/core/plan/plan_cost.h"

int main(int argc, char** argv) {
  double size = 1, most = 4, most_gap = 100;
  std::string only;
  CLI::App app("What plans look to cost, and what they cost");
  app.add_option("--size", size, "of each; the work grows with its square");
  app.add_option("--most", most, "that a price may be wrong by");
  app.add_option("--most-gap", most_gap, "milliseconds between two looks");
  app.add_option("--only", only, "kinds whose names have this in them");
  CLI11_PARSE(app, argc, argv);
  bool all = true;
  std::vector<tet::test::CostCase> cases = tet::test::cost_cases(size);
  cases.insert(cases.begin(), tet::test::plain_ball(40 * size));
  for (const tet::test::CostCase& one : cases) {
    if (!absl::StrContains(one.name, only)) continue;
    const tet::test::PlanCost cost = tet::test::cost_of(one);
    const double ratio = cost.taken / cost.price;
    all &= ratio <= most && ratio >= 1 / most && cost.longest_gap <= most_gap;
    std::cout
        << absl::StrFormat(
               "%-42s price %8.1f ms (in %5.2f)  took %8.1f ms, %6.2f times; gap %6.1f ms %s\n",
               one.name, cost.price, cost.pricing, cost.taken, ratio, cost.longest_gap,
               cost.refusal)
        << std::flush;
  }
  return all ? 0 : 1;
}
