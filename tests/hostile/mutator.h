// Broken .vdb files without end, each of which can be made again from two numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/vdb/walk/vdb_cursor.h"
#include "tests/hostile/random_bits.h"

namespace tet::test {

/// A file that is as it should be, and where its fields are.
struct SeedFile {
  std::string name;
  std::string bytes;
  std::vector<VdbField> fields;                                ///< as the walker met them
  std::map<std::string_view, std::vector<std::size_t>> named;  ///< indices of fields
};

/// Walks over the file to find its fields.
SeedFile make_seed(std::string name, std::string bytes);

struct Mutant {
  std::string bytes;
  bool changed = false;     ///< at all: a lie may happen to be the truth
  std::string description;  ///< "ball-zip: chunk length#3 = -1; 4 bits flipped"
};

/// Makes mutants of seed files that know where lengths, counts, masks and offsets are: mutant i
/// of a campaign depends on the seeds, the campaign's number and i alone.
///
/// Immutable: any number of threads may make mutants.
class Mutator {
 public:
  Mutator(std::vector<SeedFile> seeds, std::uint64_t campaign)
      : seeds_(std::move(seeds)), campaign_(campaign) {}

  Mutant mutant(std::uint64_t index) const;

 private:
  const SeedFile& pick(RandomBits& random) const { return seeds_[random.below(seeds_.size())]; }
  void mutate(const SeedFile& seed, Mutant& mutant, RandomBits& random) const;

  std::vector<SeedFile> seeds_;
  std::uint64_t campaign_;
};

}  // namespace tet::test
