#include "client/library/upload.h"

#include <cstddef>
#include <fstream>

#include <absl/strings/str_cat.h>

#include "client/library/client_call.h"
#include "client/library/raw_call.h"
#include "proto/wire/block_pool.h"
#include "proto/wire/serialized.h"
#include "proto/wire/transport.h"
#include "proto/wire/upload_frame.h"
#include "tetstream/v1/grids.grpc.pb.h"

namespace tet {

namespace {

/// Reads a file piece by piece into the messages that carry it.
class PieceReader {
 public:
  PieceReader(const LocalFile& file, std::uint64_t offset)
      : input_(file.path, std::ios::binary), offset_(offset) {
    input_.seekg(static_cast<std::streamoff>(offset));
  }

  /// The next piece as an UploadGridRequest; of nothing at the end of the file.
  grpc::ByteBuffer next() {
    const grpc::Slice block = blocks_.take(FieldWriter::kCapacity + kUploadPieceBytes);
    auto* const bytes = reinterpret_cast<char*>(const_cast<std::uint8_t*>(block.begin()));
    auto* const piece = bytes + FieldWriter::kCapacity;
    input_.read(piece, std::streamsize{kUploadPieceBytes});
    size_ = static_cast<std::size_t>(input_.gcount());
    const FieldWriter prefix = upload_prefix(offset_, size_);
    prefix.copy_before(reinterpret_cast<std::byte*>(piece));
    offset_ += size_;
    const grpc::Slice message =
        block.sub(FieldWriter::kCapacity - prefix.size(), FieldWriter::kCapacity + size_);
    return {&message, 1};
  }

  /// Bytes of the file in the last piece, and where it ended.
  std::size_t piece_bytes() const { return size_; }
  std::uint64_t offset() const { return offset_; }

 private:
  // One is being sent, one is in the transport's hands, and one is read.
  static constexpr std::size_t kBlocks = 3;

  BlockPool blocks_{FieldWriter::kCapacity + kUploadPieceBytes, kBlocks};
  std::ifstream input_;
  std::uint64_t offset_;
  std::size_t size_ = 0;
};

/// Writes what the server lacks, until it stops listening.
void write_pieces(RawCall& call,
                  const LocalFile& file,
                  std::uint64_t offset,
                  const ClientProgress& progress) {
  v1::UploadGridRequest start;
  start.mutable_start()->set_name(file.name);
  start.mutable_start()->set_size_bytes(static_cast<std::int64_t>(file.size_bytes));
  if (!call.write(serialized(start))) return;
  for (PieceReader reader(file, offset); reader.offset() < file.size_bytes;) {
    const grpc::ByteBuffer piece = reader.next();
    if (reader.piece_bytes() == 0) break;  // the file shrank: the server will miss the rest
    if (!call.write(piece)) return;
    if (progress.upload) progress.upload(reader.offset(), file.size_bytes);
  }
  call.writes_done();
}

}  // namespace

absl::Status upload_from(const ServerChannel& channel,
                         const LocalFile& file,
                         std::uint64_t offset,
                         const ClientProgress& progress,
                         const Cancellation& cancellation) {
  ClientCall attempt(channel, cancellation);
  RawCall call(channel.channel(), attempt.context(), v1::GridService::service_full_name(),
               "UploadGrid");
  write_pieces(call, file, offset, progress);
  grpc::ByteBuffer answer;
  v1::UploadGridResponse response;
  const bool answered = call.read(answer) && deserialize(answer, response);
  const absl::Status status = attempt.result(call.finish());
  if (!status.ok() || (answered && response.complete())) return status;
  return absl::AbortedError(absl::StrCat("the server holds ", response.committed_size(), " of ",
                                         file.size_bytes, " bytes; did ", file.path,
                                         " change?"));
}

}  // namespace tet
