#include "server/jobs/results/stored_mesh.h"

#include <algorithm>
#include <utility>

namespace tet {

namespace {}  // namespace

std::shared_ptr<const StoredMesh> StoredMesh::find(const ResultStore& results,
                                                   const std::string& space,
                                                   stored::JobPlan plan,
                                                   std::uint64_t first,
                                                   std::uint64_t end) {
  const v1::MeshHeader& header = plan.header();
  const auto folder = results.find({space, header.mesh_id()});
  if (!folder.ok()) return nullptr;
  const std::int64_t last = end == 0 ? header.chunk_count() : static_cast<std::int64_t>(end);
  auto first_chunk = static_cast<std::uint64_t>(header.chunk_count());
  std::string digests;
  for (const ChunkRange& range : shards_of(header.chunk_count())) {
    if (range.end <= static_cast<std::int64_t>(first) || range.first >= last) continue;
    const auto found = (*folder)->find_whole_shard(range);
    if (!found) return nullptr;
    first_chunk = std::min(first_chunk, static_cast<std::uint64_t>(range.first));
    for (const ChunkDigest& digest : *found) digests += digest;
  }
  return std::make_shared<const StoredMesh>(std::move(plan), *folder, first_chunk,
                                            std::move(digests));
}

std::shared_ptr<const StoredMesh> StoredMesh::find(const ResultStore& results,
                                                   const std::string& space,
                                                   const std::string& request_name,
                                                   std::uint64_t first,
                                                   std::uint64_t end) {
  stored::JobPlan plan;
  const auto kept = results.find_plan(space, request_name);
  if (!kept || !plan.ParseFromString(*kept)) return nullptr;
  return find(results, space, std::move(plan), first, end);
}

absl::StatusOr<ChunkMessage> StoredMesh::chunk(std::uint64_t index,
                                               BlockPool& blocks,
                                               std::shared_ptr<SendBudget::Lease> held) const {
  const std::size_t at = (index - first_chunk_) * kDigestBytes;
  return folder_->get_chunk(digests_.substr(at, kDigestBytes), blocks, std::move(held));
}

}  // namespace tet
