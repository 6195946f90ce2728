#include "core/vdb/walk/walk_metadata.h"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <string_view>

#include <absl/strings/str_format.h>

#include "core/vdb/walk/walk_chunk.h"
#include "core/vdb/walk/walk_refusal.h"

namespace tet {
namespace {

struct FixedType {
  std::string_view name;
  std::uint32_t bytes;
};

/// Every type that openvdb::initialize registers, apart from strings and "__delayedload"; a
/// test compares.
constexpr std::array kFixedTypes{
    FixedType{"bool", 1},    FixedType{"float", 4},   FixedType{"double", 8},
    FixedType{"int32", 4},   FixedType{"int64", 8},   FixedType{"vec2i", 8},
    FixedType{"vec2s", 8},   FixedType{"vec2d", 16},  FixedType{"vec3i", 12},
    FixedType{"vec3s", 12},  FixedType{"vec3d", 24},  FixedType{"vec4i", 16},
    FixedType{"vec4s", 16},  FixedType{"vec4d", 32},  FixedType{"mat4s", 64},
    FixedType{"mat4d", 128}, FixedType{"ptidx32", 4}, FixedType{"ptidx64", 8},
};

constexpr std::uint32_t kLongestType = 64;
constexpr std::uint32_t kLongestClass = 64;

constexpr std::uint32_t kMostTextBytes = 1000;
constexpr std::size_t kMostTexts = 100;

/// An entry takes at least three lengths and a name.
constexpr std::uint64_t kSmallestEntry = 13;

struct Entry {
  std::uint64_t at = 0;
  std::string name, type;
  std::uint32_t bytes = 0;
};

Entry read_entry(VdbCursor& cursor, const MetadataLimits& limits) {
  Entry entry;
  entry.at = cursor.position();
  entry.name = cursor.read_string(limits.name_bytes, "metadata name", "metadata name text");
  entry.type = cursor.read_string(kLongestType, "metadata type", "metadata type text");
  entry.bytes = cursor.read<std::uint32_t>("metadata size");
  if (entry.name.empty()) refuse_at(entry.at, "a metadata entry has no name");
  if (entry.bytes > cursor.left()) {
    refuse_at(entry.at, absl::StrFormat("metadata %s claims %d bytes and %d are left",
                                        quoted_name(entry.name), entry.bytes, cursor.left()));
  }
  return entry;
}

void check_size(const Entry& entry) {
  const auto* type = std::find_if(kFixedTypes.begin(), kFixedTypes.end(),
                                  [&](const FixedType& t) { return t.name == entry.type; });
  if (type != kFixedTypes.end() && type->bytes != entry.bytes) {
    refuse_at(entry.at,
              absl::StrFormat("metadata %s is a %s of %d bytes, not of %d",
                              quoted_name(entry.name), type->name, entry.bytes, type->bytes));
  }
}

bool walk_bool(VdbCursor& cursor) {
  const std::uint64_t at = cursor.position();
  const auto value = cursor.read<std::uint8_t>("metadata flag");
  if (value > 1) refuse_at(at, absl::StrFormat("a metadata flag is %d", value));
  return value != 0;
}

std::string walk_class(VdbCursor& cursor, const Entry& entry) {
  if (entry.type != "string" || entry.bytes > kLongestClass) {
    refuse_at(entry.at, absl::StrFormat("the grid class is a %s of %d bytes",
                                        quoted_name(entry.type), entry.bytes));
  }
  const std::byte* text = cursor.take(entry.bytes, "grid class");
  return {reinterpret_cast<const char*>(text), entry.bytes};
}

/// Small arrays are made longer before they are compressed.
constexpr std::uint64_t kPaddedBytes = 128;

/// `bytes` bytes, as they are or, after a length that is not zero, with blosc.
void walk_delayed_array(VdbCursor& cursor, std::uint64_t length, std::uint64_t bytes) {
  if (length == 0) return cursor.skip(bytes, "leaf places");
  if (length > cursor.left()) {
    refuse_at(cursor.position(), absl::StrFormat("places of leaves claim %d bytes", length));
  }
  walk_blosc(cursor, length, std::max(bytes, kPaddedBytes));
}

/// Where a reader finds the leaves later: a byte for each and, where they are compressed, a
/// length for each.
std::uint64_t walk_delayed_load(VdbCursor& cursor, const Entry& entry) {
  constexpr auto kNoLengths = std::numeric_limits<std::uint32_t>::max();
  if (entry.bytes == 0) return 0;
  const std::uint64_t start = cursor.position();
  const std::uint64_t leaves = cursor.read<std::uint32_t>("places count");
  walk_delayed_array(cursor, cursor.read<std::uint32_t>("places length"), leaves);
  const auto lengths = cursor.read<std::uint32_t>("lengths length");
  if (lengths != kNoLengths) walk_delayed_array(cursor, lengths, leaves * sizeof(std::int64_t));
  if (cursor.position() - start != entry.bytes) {
    refuse_at(start, absl::StrFormat("places of leaves take %d bytes and claim %d",
                                     cursor.position() - start, entry.bytes));
  }
  return leaves;
}

void walk_value(VdbCursor& cursor, const Entry& entry, WalkedMetadata& walked) {
  constexpr std::string_view kHalfFloat = "is_saved_as_half_float";
  if (entry.name == kHalfFloat && entry.type != "bool") {
    refuse_at(entry.at,
              absl::StrFormat("metadata '%s' is a %s", kHalfFloat, quoted_name(entry.type)));
  }
  if (entry.name == "class") {
    walked.grid_class = walk_class(cursor, entry);
  } else if (entry.type == "bool") {
    const bool value = walk_bool(cursor);
    if (entry.name == kHalfFloat) walked.half_float = value;
  } else if (entry.type == "__delayedload") {
    walked.delayed_leaves = walk_delayed_load(cursor, entry);
  } else {
    cursor.skip(entry.bytes, "metadata value");
  }
}

void check_count(VdbCursor& cursor, std::uint32_t count, const MetadataLimits& limits) {
  if (count > cursor.left() / kSmallestEntry) {
    refuse_at(cursor.position(),
              absl::StrFormat("%d metadata entries do not fit %d bytes", count, cursor.left()));
  }
  if (count > limits.entries) {
    refuse_over_limit(absl::StrFormat("there are %d metadata entries and the limit is %d",
                                      count, limits.entries));
  }
}

}  // namespace

WalkedMetadata walk_metadata(VdbCursor& cursor, const MetadataLimits& limits) {
  const auto count = cursor.read<std::uint32_t>("metadata count");
  check_count(cursor, count, limits);
  const std::uint64_t start = cursor.position();
  std::set<std::string> names;
  WalkedMetadata walked;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Entry entry = read_entry(cursor, limits);
    check_size(entry);
    if (!names.insert(entry.name).second) {
      refuse_at(entry.at,
                absl::StrFormat("there are two metadata %s", quoted_name(entry.name)));
    }
    if (cursor.position() - start + entry.bytes > limits.bytes) {
      refuse_over_limit(
          absl::StrFormat("metadata takes more than the limit of %d bytes", limits.bytes));
    }
    walk_value(cursor, entry, walked);
  }
  return walked;
}

std::vector<std::pair<std::string, std::string>> read_texts(VdbCursor& cursor,
                                                            std::string_view prefix,
                                                            const MetadataLimits& limits) {
  const auto count = cursor.read<std::uint32_t>("metadata count");
  check_count(cursor, count, limits);
  std::vector<std::pair<std::string, std::string>> texts;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Entry entry = read_entry(cursor, limits);
    std::uint32_t taken = 0;
    if (entry.type == "string" && entry.name.starts_with(prefix) && texts.size() < kMostTexts) {
      taken = std::min(entry.bytes, kMostTextBytes);
      const std::byte* text = cursor.take(taken, "metadata value");
      texts.emplace_back(entry.name, std::string(reinterpret_cast<const char*>(text), taken));
    }
    cursor.skip(entry.bytes - taken, "metadata value");
  }
  std::ranges::sort(texts);
  return texts;
}

}  // namespace tet
