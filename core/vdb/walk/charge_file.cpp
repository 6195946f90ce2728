#include "core/vdb/walk/charge_file.h"

#include <absl/strings/str_format.h>

#include "core/base/posix/byte_source.h"
#include "core/vdb/walk/walk_vdb.h"

namespace tet {
namespace {

absl::Status told_of(const OpenGridFile& file, const char* what, const absl::Status& why) {
  return {why.code(),
          absl::StrFormat("'%s'%s: %s", file.name, what, std::string(why.message()))};
}

}  // namespace

absl::StatusOr<MemoryCharge> charge_file(
    const OpenGridFile& file,
    const std::function<MemoryCharge(const VdbOutline&)>& charge_of,
    std::uint64_t max_volume_bytes,
    std::uint64_t max_reading_bytes,
    const std::function<bool()>& cancelled) {
  const ByteSource source(file.descriptor, static_cast<std::uint64_t>(file.size_bytes));
  const absl::StatusOr<VdbOutline> outline = walk_vdb(source, {.cancelled = cancelled});
  if (absl::IsCancelled(outline.status())) return outline.status();
  if (!outline.ok()) {
    const bool bad = absl::IsInvalidArgument(outline.status());
    return told_of(file, bad ? " is not a readable VDB file" : "", outline.status());
  }
  const MemoryCharge charge = charge_of(*outline);
  const absl::Status fits = check_memory(charge, max_volume_bytes, max_reading_bytes);
  if (!fits.ok()) return told_of(file, "", fits);
  return charge;
}

}  // namespace tet
