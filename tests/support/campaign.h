// Random inputs, one after another on several threads, until there have been enough.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "core/base/parallel.h"

namespace tet::test {

/// Calls `try_input(i, pool)` with 0, 1, ... and a pool of one thread, from so many threads at
/// once, until it returns false or `inputs` have been tried.
template <class TryInput>
void try_inputs(unsigned threads, std::uint64_t inputs, const TryInput& try_input) {
  std::atomic<std::uint64_t> next{0};
  std::atomic<bool> enough{false};
  const auto work = [&] {
    TaskPool pool(1);
    for (std::uint64_t i = next++; i < inputs && !enough; i = next++) {
      if (!try_input(i, pool)) enough = true;
    }
  };
  std::vector<std::jthread> all;
  for (unsigned i = 0; i < threads; ++i) all.emplace_back(work);
}

}  // namespace tet::test
