#include "server/jobs/results/stored_chunk.h"

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "proto/wire/sha256.h"

namespace tet {

namespace {

struct Tail {
  std::uint64_t tets = 0, bytes = 0;
  QualityStats quality;
};
static_assert(sizeof(Tail) == 16 + 24 + 8 * QualityStats::kBins);
static_assert(std::is_trivially_copyable_v<Tail>);
static_assert(std::endian::native == std::endian::little);

std::vector<grpc::Slice> slices_of(const ChunkMessage& chunk) {
  std::vector<grpc::Slice> slices;
  chunk.event.Dump(&slices);
  return slices;
}

std::string_view text_of(const grpc::Slice& slice) {
  return {reinterpret_cast<const char*>(slice.begin()), slice.size()};
}

Tail tail_of(const ChunkMessage& chunk) { return {chunk.tets, chunk.bytes, chunk.quality}; }

std::string_view text_of(const Tail& tail) {
  return {reinterpret_cast<const char*>(&tail), sizeof tail};
}

absl::Status damaged(const std::string& what) { return absl::DataLossError(what); }

absl::Status read_all(const File& file, std::uint64_t offset, std::span<char> bytes) {
  const auto count = file.read_at(offset, bytes);
  if (!count.ok()) return count.status();
  return *count == bytes.size() ? absl::OkStatus() : damaged("it ends early");
}

}  // namespace

std::uint64_t stored_bytes(const ChunkMessage& chunk) {
  return chunk.event.Length() + sizeof(Tail);
}

std::string digest_of(const ChunkMessage& chunk) {
  Sha256 digest;
  for (const grpc::Slice& slice : slices_of(chunk)) digest.add(text_of(slice));
  const Tail tail = tail_of(chunk);
  digest.add(text_of(tail));
  return digest.finish_hex();
}

absl::Status write_chunk(const ChunkMessage& chunk, File& file) {
  std::uint64_t offset = 0;
  for (const grpc::Slice& slice : slices_of(chunk)) {
    if (auto status = file.write_at(offset, text_of(slice)); !status.ok()) return status;
    offset += slice.size();
  }
  const Tail tail = tail_of(chunk);
  return file.write_at(offset, text_of(tail));
}

absl::StatusOr<ChunkMessage> read_chunk(const File& file,
                                        const std::string& digest,
                                        BlockPool& blocks,
                                        std::shared_ptr<SendBudget::Lease> held) {
  const auto size = file.size();
  if (!size.ok()) return size.status();
  if (*size < sizeof(Tail)) return damaged(absl::StrCat("it has only ", *size, " bytes"));
  const std::uint64_t event_bytes = *size - sizeof(Tail);
  const grpc::Slice slice = blocks.take(event_bytes, std::move(held));
  auto* const block = reinterpret_cast<char*>(const_cast<std::uint8_t*>(slice.begin()));
  Tail tail;
  absl::Status status = read_all(file, 0, {block, event_bytes});
  if (status.ok()) {
    status = read_all(file, event_bytes, {reinterpret_cast<char*>(&tail), sizeof tail});
  }
  if (!status.ok()) return status;
  Sha256 found;
  found.add(text_of(slice));
  found.add(text_of(tail));
  if (found.finish_hex() != digest) return damaged("it has other bytes");
  return ChunkMessage{grpc::ByteBuffer(&slice, 1), tail.quality, tail.tets, tail.bytes};
}

}  // namespace tet
