#include "core/vdb/walk/walk_vdb.h"

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/check_file.h"
#include "core/base/posix/file.h"
#include "core/vdb/walk/grid_names.h"
#include "core/vdb/walk/walk_grid.h"
#include "core/vdb/walk/walk_refusal.h"

namespace tet {
namespace {

/// The bytes " BDV", then four zeros.
constexpr std::uint64_t kMagic = 0x56444220;

/// The first in which every node tells how it is compressed, and the newest there is.
constexpr std::uint32_t kOldestFormat = 222;
constexpr std::uint32_t kNewestFormat = 224;

/// OpenVDB has reached 13.
constexpr std::uint32_t kNewestLibrary = 99;

void walk_format(VdbCursor& cursor, VdbOutline& outline) {
  if (cursor.read<std::uint64_t>("magic number") != kMagic) refuse_at(0, "it is no VDB file");
  const std::uint64_t at = cursor.position();
  outline.format = cursor.read<std::uint32_t>("format");
  if (outline.format < kOldestFormat || outline.format > kNewestFormat) {
    refuse_at(at, absl::StrFormat("its format is %d, and only %d to %d can be read: write it "
                                  "again with OpenVDB 10",
                                  outline.format, kOldestFormat, kNewestFormat));
  }
}

void walk_library(VdbCursor& cursor, VdbOutline& outline) {
  const std::uint64_t at = cursor.position();
  outline.library_major = cursor.read<std::uint32_t>("library major version");
  outline.library_minor = cursor.read<std::uint32_t>("library minor version");
  if (outline.library_major > kNewestLibrary || outline.library_minor > kNewestLibrary) {
    refuse_at(at, absl::StrFormat("OpenVDB %d.%d does not exist", outline.library_major,
                                  outline.library_minor));
  }
}

void walk_offsets_flag(VdbCursor& cursor, VdbOutline& outline) {
  const std::uint64_t at = cursor.position();
  const auto flag = cursor.read<std::uint8_t>("offsets flag");
  if (flag > 1) refuse_at(at, absl::StrFormat("the flag for offsets is %d", flag));
  outline.has_offsets = flag == 1;
}

void walk_uuid(VdbCursor& cursor) {
  constexpr std::string_view kPattern = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";
  const std::uint64_t at = cursor.position();
  const std::byte* text = cursor.take(kPattern.size(), "uuid");
  for (std::size_t i = 0; i < kPattern.size(); ++i) {
    const auto c = std::to_integer<unsigned char>(text[i]);
    const bool fits = kPattern[i] == '-' ? c == '-' : std::isxdigit(c) != 0;
    if (!fits) refuse_at(at + i, "its uuid is not one");
  }
}

void walk_header(VdbCursor& cursor, VdbOutline& outline) {
  walk_format(cursor, outline);
  walk_library(cursor, outline);
  walk_offsets_flag(cursor, outline);
  walk_uuid(cursor);
}

std::int32_t read_grid_count(VdbCursor& cursor, const WalkLimits& limits) {
  // Three strings, three offsets, the compression, a count and a map's name.
  constexpr std::uint64_t kSmallestGrid = 3 * 4 + 3 * 8 + 4 + 4 + 4;
  const std::uint64_t at = cursor.position();
  const auto count = cursor.read<std::int32_t>("grid count");
  if (count < 0 || static_cast<std::uint64_t>(count) > cursor.left() / kSmallestGrid) {
    refuse_at(at, absl::StrFormat("%d grids do not fit %d bytes", count, cursor.left()));
  }
  if (static_cast<std::uint32_t>(count) > limits.grids) {
    refuse_over_limit(
        absl::StrFormat("there are %d grids and the limit is %d", count, limits.grids));
  }
  return count;
}

void name_grids(VdbOutline& outline) {
  std::vector<std::string> stored;
  for (const GridOutline& grid : outline.grids) stored.push_back(grid.unique_name);
  const std::vector<std::string> names = shown_names(stored);
  for (std::size_t i = 0; i < names.size(); ++i) outline.grids[i].name = names[i];
}

VdbOutline walk_file(VdbCursor& cursor, std::uint64_t file_bytes, const WalkLimits& limits) {
  VdbOutline outline;
  outline.file_bytes = file_bytes;
  walk_header(cursor, outline);
  const std::uint64_t at = cursor.position();
  if (walk_metadata(cursor, limits.metadata).delayed_leaves.value_or(0) != 0) {
    refuse_at(at, "the file itself has places for leaves");
  }
  const std::int32_t count = read_grid_count(cursor, limits);
  for (std::int32_t i = 0; i < count; ++i) {
    outline.grids.push_back(walk_grid(cursor, outline, limits));
  }
  name_grids(outline);
  if (cursor.left() != 0) {
    refuse_at(cursor.position(),
              absl::StrFormat("%d bytes follow the last grid", cursor.left()));
  }
  return outline;
}

}  // namespace

absl::StatusOr<VdbOutline> walk_vdb(const ByteSource& source,
                                    const WalkLimits& limits,
                                    std::vector<VdbField>* fields) {
  try {
    VdbCursor cursor(source, fields, limits.cancelled);
    return walk_file(cursor, source.size(), limits);
  } catch (const WalkRefusal& refusal) {
    return refusal.status();
  }
}

absl::StatusOr<VdbOutline> walk_vdb(const std::string& path, const WalkLimits& limits) {
  if (absl::Status s = check_file(path); !s.ok()) return s;
  const absl::StatusOr<File> file = File::open(path, O_RDONLY, io_error);
  const auto size = file.ok() ? file->size() : file.status();
  if (!size.ok()) {
    return absl::PermissionDeniedError(absl::StrFormat("'%s' cannot be opened", path));
  }
  return walk_vdb(ByteSource(file->descriptor().number(), *size), limits);
}

}  // namespace tet
