#include "core/plan/brick/new_parts.h"

namespace tet {

NewNumbers::NewNumbers(std::span<const KeptRun> kept) : kept_(kept) {
  kept_before_.reserve(kept.size() + 1);
  std::uint64_t before = 0;
  for (const KeptRun& run : kept) {
    kept_before_.push_back(before);
    before += run.count;
  }
  kept_before_.push_back(before);
}

std::size_t NewNumbers::run_behind(std::uint64_t number) const noexcept {
  const auto run = std::ranges::upper_bound(kept_, number, {},
                                            [](const KeptRun& r) { return r.to + r.count; });
  return static_cast<std::size_t>(run - kept_.begin());
}

std::uint64_t NewNumbers::before(std::uint64_t number) const noexcept {
  const std::size_t run = run_behind(number);
  std::uint64_t kept = kept_before_[run];
  if (run < kept_.size() && kept_[run].to < number) kept += number - kept_[run].to;
  return number - kept;
}

ChunkExtent NewParts::within(const ChunkExtent& whole) const noexcept {
  ChunkExtent part;
  part.first_vertex = vertices_.before(whole.first_vertex);
  part.vertex_count =
      vertices_.before(whole.first_vertex + whole.vertex_count) - part.first_vertex;
  part.first_tet = tets_.before(whole.first_tet);
  part.tet_count = tets_.before(whole.first_tet + whole.tet_count) - part.first_tet;
  return part;
}

const BrickMask* NewParts::cells(std::size_t brick) const noexcept {
  const auto part = std::ranges::lower_bound(partly_, brick, {}, &PartlyNew::brick);
  return part != partly_.end() && part->brick == brick ? &part->cells : nullptr;
}

}  // namespace tet
