// Single changes to a .vdb file, by kind. Each returns what it did, for people.
#pragma once

#include <string>

#include "tests/hostile/mutator.h"
#include "tests/hostile/random_bits.h"

namespace tet::test {

/// Changes `bytes`, a file that was made from `seed` and may have been changed before.
using Mutation = std::string (*)(const SeedFile& seed, std::string& bytes, RandomBits& random);

std::string flip_bit(const SeedFile& seed, std::string& bytes, RandomBits& random);
std::string flip_many_bits(const SeedFile& seed, std::string& bytes, RandomBits& random);
std::string overwrite_block(const SeedFile& seed, std::string& bytes, RandomBits& random);
std::string truncate(const SeedFile& seed, std::string& bytes, RandomBits& random);
std::string truncate_at_field(const SeedFile& seed, std::string& bytes, RandomBits& random);
std::string insert_bytes(const SeedFile& seed, std::string& bytes, RandomBits& random);
std::string delete_bytes(const SeedFile& seed, std::string& bytes, RandomBits& random);

/// A field of any name says another number: extreme, nearly right, or anything.
std::string lie_in_field(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// One value where two places must agree, in both: leaf masks, half floats, lengths of chunks.
std::string lie_twice(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// Bits of a mask: one, all, none.
std::string change_mask(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// Bytes within compressed data, which the walker passes over.
std::string change_payload(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// A number that nothing else depends on: values, transforms.
std::string change_number(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// A field has the bytes of another of its name.
std::string copy_field(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// The grid's type is another of the same length.
std::string swap_type(const SeedFile& seed, std::string& bytes, RandomBits& random);
/// Deletes or repeats whole fields, and moves the offsets that follow so that they agree.
std::string move_fields(const SeedFile& seed, std::string& bytes, RandomBits& random);

/// The file up to a field of `seed`, and from a field of that name on what `other` has.
std::string splice(const SeedFile& seed,
                   const SeedFile& other,
                   std::string& bytes,
                   RandomBits& random);

}  // namespace tet::test
