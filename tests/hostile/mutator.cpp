#include "tests/hostile/mutator.h"

#include <array>
#include <span>
#include <stdexcept>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/vdb/walk/walk_vdb.h"
#include "tests/hostile/mutations.h"

namespace tet::test {
namespace {

/// How often each is used, out of all of them: lies about fields find the most.
struct Weighted {
  Mutation mutation;
  std::uint32_t weight;
};

constexpr std::array kMutations{
    Weighted{flip_bit, 10},    Weighted{flip_many_bits, 4},    Weighted{overwrite_block, 6},
    Weighted{truncate, 4},     Weighted{truncate_at_field, 4}, Weighted{insert_bytes, 3},
    Weighted{delete_bytes, 3}, Weighted{lie_in_field, 36},     Weighted{lie_twice, 4},
    Weighted{change_mask, 6},  Weighted{change_payload, 6},    Weighted{change_number, 6},
    Weighted{copy_field, 4},   Weighted{swap_type, 2},         Weighted{move_fields, 4},
};

constexpr std::uint32_t kSpliceWeight = 6;

std::uint32_t total_weight() {
  std::uint32_t sum = kSpliceWeight;
  for (const Weighted& w : kMutations) sum += w.weight;
  return sum;
}

/// One change mostly; several at times, since one may hide behind another.
std::uint64_t count_changes(RandomBits& random) {
  const std::uint64_t dice = random.below(16);
  if (dice < 11) return 1;
  return dice < 14 ? 2 : 3 + random.below(6);
}

}  // namespace

SeedFile make_seed(std::string name, std::string bytes) {
  SeedFile seed{std::move(name), std::move(bytes), {}, {}};
  const ByteSource source(std::as_bytes(std::span(seed.bytes)));
  const auto outline = walk_vdb(source, {}, &seed.fields);
  if (!outline.ok()) {
    throw std::invalid_argument(absl::StrCat(seed.name, ": ", outline.status().ToString()));
  }
  for (std::size_t i = 0; i < seed.fields.size(); ++i) {
    if (seed.fields[i].bytes > 0) seed.named[seed.fields[i].what].push_back(i);
  }
  return seed;
}

void Mutator::mutate(const SeedFile& seed, Mutant& mutant, RandomBits& random) const {
  static const std::uint32_t total = total_weight();
  auto dice = static_cast<std::uint32_t>(random.below(total));
  for (const Weighted& w : kMutations) {
    if (dice < w.weight) {
      absl::StrAppend(&mutant.description, "; ", w.mutation(seed, mutant.bytes, random));
      return;
    }
    dice -= w.weight;
  }
  absl::StrAppend(&mutant.description, "; ", splice(seed, pick(random), mutant.bytes, random));
}

Mutant Mutator::mutant(std::uint64_t index) const {
  RandomBits random(campaign_, index);
  const SeedFile& seed = pick(random);
  Mutant mutant{seed.bytes, false, seed.name};
  const std::uint64_t changes = count_changes(random);
  for (std::uint64_t i = 0; i < changes; ++i) mutate(seed, mutant, random);
  mutant.changed = mutant.bytes != seed.bytes;
  return mutant;
}

}  // namespace tet::test
