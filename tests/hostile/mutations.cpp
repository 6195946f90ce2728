#include "tests/hostile/mutations.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>

#include <absl/strings/str_format.h>

namespace tet::test {
namespace {

/// A field of `bytes` that still lies within it; nothing when there is none of these names.
std::optional<VdbField> pick_named(const SeedFile& seed,
                                   const std::string& bytes,
                                   std::string_view name,
                                   RandomBits& random) {
  const auto found = seed.named.find(name);
  if (found == seed.named.end()) return {};
  const VdbField field = seed.fields[found->second[random.below(found->second.size())]];
  if (field.offset + field.bytes > bytes.size()) return {};
  return field;
}

/// Names first, so that the few headers are found as often as the many leaves.
std::optional<VdbField> pick_any(const SeedFile& seed,
                                 const std::string& bytes,
                                 RandomBits& random) {
  const auto name = std::next(seed.named.begin(),
                              static_cast<std::ptrdiff_t>(random.below(seed.named.size())));
  return pick_named(seed, bytes, name->first, random);
}

std::optional<VdbField> pick_of(const SeedFile& seed,
                                const std::string& bytes,
                                std::initializer_list<std::string_view> names,
                                RandomBits& random) {
  for (int tries = 0; tries < 8; ++tries) {
    const auto field =
        pick_named(seed, bytes, names.begin()[random.below(names.size())], random);
    if (field) return field;
  }
  return {};
}

std::size_t number_bytes(const VdbField& field) {
  return static_cast<std::size_t>(std::min<std::uint64_t>(field.bytes, 8));
}

std::uint64_t get(const std::string& bytes, const VdbField& field) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + field.offset, number_bytes(field));
  return value;
}

void put(std::string& bytes, const VdbField& field, std::uint64_t value) {
  std::memcpy(bytes.data() + field.offset, &value, number_bytes(field));
}

/// Something that a number's reader may not have thought of.
std::uint64_t interesting(std::uint64_t old, std::uint64_t file_bytes, RandomBits& random) {
  switch (random.below(14)) {
    case 0:
      return 0;
    case 1:
      return ~std::uint64_t{0};
    case 2:
      return old + 1;
    case 3:
      return old - 1;
    case 4:
      return old * 2;
    case 5:
      return old / 2;
    case 6:
      return ~old + 1;
    case 7:
      return std::uint64_t{1} << random.below(64);
    case 8:
      return (std::uint64_t{1} << random.below(64)) - 1;
    case 9:
      return ~std::uint64_t{0} << random.below(64);
    case 10:
      return file_bytes;
    case 11:
      return old ^ (std::uint64_t{1} << random.below(64));
    case 12:
      return random.below(300);
    default:
      return random.next();
  }
}

std::string told(const char* what, const VdbField& field, std::uint64_t value) {
  return absl::StrFormat("%s %s@%d = %#x", what, field.what, field.offset, value);
}

std::string nothing() { return "nothing"; }

}  // namespace

std::string flip_bit(const SeedFile& /*seed*/, std::string& bytes, RandomBits& random) {
  if (bytes.empty()) return nothing();
  const std::uint64_t bit = random.below(bytes.size() * 8);
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
  return absl::StrFormat("bit %d", bit);
}

std::string flip_many_bits(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const std::uint64_t count = 2 + random.below(127);
  for (std::uint64_t i = 0; i < count; ++i) flip_bit(seed, bytes, random);
  return absl::StrFormat("%d bits", count);
}

std::string overwrite_block(const SeedFile& /*seed*/, std::string& bytes, RandomBits& random) {
  const std::uint64_t at = random.below(bytes.size());
  const std::uint64_t count =
      std::min<std::uint64_t>(std::uint64_t{1} << random.below(11), bytes.size() - at);
  const std::uint64_t kind = random.below(3);
  for (std::uint64_t i = at; i < at + count; ++i) {
    bytes[i] = kind == 0 ? '\0' : kind == 1 ? '\xff' : static_cast<char>(random.next());
  }
  return absl::StrFormat("%d bytes overwritten at %d", count, at);
}

std::string truncate(const SeedFile& /*seed*/, std::string& bytes, RandomBits& random) {
  bytes.resize(random.below(bytes.size()));
  return absl::StrFormat("cut to %d", bytes.size());
}

std::string truncate_at_field(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto field = pick_any(seed, bytes, random);
  if (!field) return nothing();
  bytes.resize(field->offset);
  return absl::StrFormat("cut before %s@%d", field->what, field->offset);
}

std::string insert_bytes(const SeedFile& /*seed*/, std::string& bytes, RandomBits& random) {
  const std::uint64_t at = random.below(bytes.size() + 1);
  const std::uint64_t count = std::uint64_t{1} << random.below(10);
  std::string inserted(count, '\0');
  if (random.below(2) == 0) {
    for (char& c : inserted) c = static_cast<char>(random.next());
  }
  bytes.insert(at, inserted);
  return absl::StrFormat("%d bytes inserted at %d", count, at);
}

std::string delete_bytes(const SeedFile& /*seed*/, std::string& bytes, RandomBits& random) {
  const std::uint64_t at = random.below(bytes.size());
  const std::uint64_t count = std::uint64_t{1} << random.below(10);
  bytes.erase(at, count);
  return absl::StrFormat("%d bytes deleted at %d", count, at);
}

std::string lie_in_field(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto field = pick_any(seed, bytes, random);
  if (!field) return nothing();
  const std::uint64_t value = interesting(get(bytes, *field), bytes.size(), random);
  put(bytes, *field, value);
  return told("", *field, value);
}

std::string lie_twice(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto first = pick_of(seed, bytes, {"chunk length", "leaf mask", "blosc size"}, random);
  if (!first) return nothing();
  const std::string_view name = first->what;
  const std::string_view partner = name == "chunk length" ? "blosc length"
                                   : name == "leaf mask"  ? "leaf mask again"
                                                          : "blosc block size";
  const auto& firsts = seed.named.at(first->what);
  const auto partners = seed.named.find(partner);
  if (partners == seed.named.end()) return nothing();
  const std::uint64_t nth = random.below(std::min(firsts.size(), partners->second.size()));
  const VdbField a = seed.fields[firsts[nth]];
  const VdbField b = seed.fields[partners->second[nth]];
  if (std::max(a.offset + a.bytes, b.offset + b.bytes) > bytes.size()) return nothing();
  const std::uint64_t value = interesting(get(bytes, a), bytes.size(), random);
  put(bytes, a, value);
  put(bytes, b, value);
  return told("twice", a, value);
}

std::string change_mask(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto field = pick_of(
      seed, bytes,
      {"child mask", "value mask", "leaf mask", "leaf mask again", "selection mask"}, random);
  if (!field) return nothing();
  const std::uint64_t kind = random.below(4);
  char* mask = bytes.data() + field->offset;
  if (kind == 0) {
    std::fill_n(mask, field->bytes, '\0');
  } else if (kind == 1) {
    std::fill_n(mask, field->bytes, '\xff');
  } else {
    const std::uint64_t bit = random.below(field->bytes * 8);
    mask[bit / 8] = static_cast<char>(mask[bit / 8] ^ (1 << bit % 8));
  }
  return told("changed", *field, kind);
}

std::string change_payload(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto field = pick_of(seed, bytes,
                             {"values", "chunk", "blosc stream", "blosc copy", "zlib stream",
                              "leaf places", "unwalked grid"},
                             random);
  if (!field) return nothing();
  const std::uint64_t count = 1 + random.below(16);
  for (std::uint64_t i = 0; i < count; ++i) {
    bytes[field->offset + random.below(field->bytes)] = static_cast<char>(random.next());
  }
  return told("within", *field, count);
}

std::string change_number(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::array kNumbers{0.0,  -0.0, 1.0,   -1.0, 1e-300,    1e300,
                                1e30, 0.5,  1e-30, -1e9, kInfinity, -kInfinity};
  const auto field = pick_of(seed, bytes,
                             {"background", "inactive values", "root tile value", "scale",
                              "translation", "matrix", "voxel size", "values"},
                             random);
  if (!field) return nothing();
  const bool nan = random.below(8) == 0;
  const double number = nan ? std::nan("") : kNumbers[random.below(kNumbers.size())];
  const auto small = std::bit_cast<std::uint32_t>(static_cast<float>(number));
  const std::uint64_t value = field->bytes < 8 ? small : std::bit_cast<std::uint64_t>(number);
  put(bytes, *field, value);
  return told("number", *field, value);
}

std::string copy_field(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto to = pick_any(seed, bytes, random);
  if (!to) return nothing();
  const auto from = pick_named(seed, bytes, to->what, random);
  if (!from) return nothing();
  const std::uint64_t count = std::min(from->bytes, to->bytes);
  bytes.replace(to->offset, count, bytes.substr(from->offset, count));
  return told("copied", *to, from->offset);
}

std::string swap_type(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  constexpr std::array<std::string_view, 6> kTypes{"Tree_float_5_4_3", "Tree_int32_5_4_3",
                                                   "Tree_int64_5_4_3", "Tree_vec3i_5_4_3",
                                                   "Tree_vec3s_5_4_3", "Tree_float_5_4_2"};
  const auto field = pick_named(seed, bytes, "grid type text", random);
  if (!field || field->bytes < kTypes[0].size()) return nothing();
  const std::string_view type = kTypes[random.below(kTypes.size())];
  bytes.replace(field->offset, type.size(), type);
  return absl::StrFormat("type %s", std::string(type));
}

std::string move_fields(const SeedFile& seed, std::string& bytes, RandomBits& random) {
  const auto field = pick_any(seed, bytes, random);
  if (!field || bytes.size() != seed.bytes.size()) return nothing();
  const bool repeat = random.below(2) == 0;
  const auto moved = static_cast<std::int64_t>(field->bytes) * (repeat ? 1 : -1);
  for (const char* name : {"grid offset", "block offset", "end offset"}) {
    const auto found = seed.named.find(name);
    if (found == seed.named.end()) continue;
    for (const std::size_t i : found->second) {
      const auto old = static_cast<std::int64_t>(get(bytes, seed.fields[i]));
      const bool behind = old > static_cast<std::int64_t>(field->offset);
      put(bytes, seed.fields[i], static_cast<std::uint64_t>(behind ? old + moved : old));
    }
  }
  if (repeat) {
    bytes.insert(field->offset, bytes.substr(field->offset, field->bytes));
  } else {
    bytes.erase(field->offset, field->bytes);
  }
  return told(repeat ? "repeated" : "removed", *field, field->bytes);
}

std::string splice(const SeedFile& seed,
                   const SeedFile& other,
                   std::string& bytes,
                   RandomBits& random) {
  const auto here = pick_any(seed, bytes, random);
  if (!here) return nothing();
  const auto there = pick_named(other, other.bytes, here->what, random);
  if (!there) return nothing();
  bytes.resize(here->offset);
  bytes += other.bytes.substr(there->offset);
  return absl::StrFormat("from %s@%d on %s@%d", here->what, here->offset, other.name,
                         there->offset);
}

}  // namespace tet::test
