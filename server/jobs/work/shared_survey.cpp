#include "server/jobs/work/shared_survey.h"

#include <utility>

#include <absl/strings/str_cat.h>
#include <grpcpp/support/slice.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {

/// The name of the folder, in the place of a mesh's.
std::string folder_of(const SurveyName& name) {
  Sha256 digest;
  digest.add(absl::StrCat("survey of ", name.request, " by ", name.block_bricks));
  return digest.finish_hex();
}

absl::Status alarm(std::int64_t block) {
  return with_reason(
      absl::DataLossError(
          absl::StrCat("block ", block, " of a survey was made with other bytes than before")),
      "DETERMINISM_ALARM");
}

}  // namespace

absl::StatusOr<std::shared_ptr<SharedSurvey>> SharedSurvey::open(ResultStore& results,
                                                                 BlockPool& memory,
                                                                 const SurveyName& name) {
  auto folder = results.make({name.space, folder_of(name)});
  if (!folder.ok()) return folder.status();
  return std::make_shared<SharedSurvey>(results, memory, *std::move(folder), name.block_bricks);
}

std::optional<ChunkDigest> SharedSurvey::digest_of(std::int64_t block) const {
  const auto digests = folder_->find_whole_shard({block, block + 1});
  if (!digests) return std::nullopt;
  return digests->front();
}

absl::StatusOr<ChunkDigest> SharedSurvey::put(std::int64_t block,
                                              std::span<const std::byte> bytes) {
  const ChunkRange range{block, block + 1};
  const grpc::Slice slice(bytes.data(), bytes.size());
  const ChunkMessage message{grpc::ByteBuffer(&slice, 1), {}, 0, bytes.size()};
  const auto chunk = results_.put_chunk(*folder_, message);
  if (!chunk.ok()) return chunk.status();
  const auto before = folder_->find_shard(range);
  if (before && before->front() != chunk->digest) return alarm(block);
  if (auto kept = folder_->put_shard(range, {chunk->digest}); !kept.ok()) return kept;
  return chunk->digest;
}

std::optional<std::vector<std::byte>> SharedSurvey::get(std::int64_t block) const {
  const auto digest = digest_of(block);
  if (!digest) return std::nullopt;
  const auto message = folder_->get_chunk(*digest, memory_, nullptr);
  if (!message.ok()) return std::nullopt;
  std::vector<grpc::Slice> slices;
  message->event.Dump(&slices);
  std::vector<std::byte> bytes;
  bytes.reserve(message->event.Length());
  for (const grpc::Slice& slice : slices) {
    const auto part = std::as_bytes(std::span(slice.begin(), slice.size()));
    bytes.insert(bytes.end(), part.begin(), part.end());
  }
  return bytes;
}

SurveyedBlocks SharedSurvey::blocks(std::shared_ptr<const SharedSurvey> survey) {
  const auto block_bricks = static_cast<std::size_t>(survey->block_bricks_);
  return {block_bricks, [survey = std::move(survey)](std::size_t block) {
            return survey->get(static_cast<std::int64_t>(block));
          }};
}

}  // namespace tet
