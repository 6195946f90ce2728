#include "client/library/upload.h"

#include <cstddef>
#include <utility>

#include <absl/status/statusor.h>
#include <absl/strings/str_cat.h>

#include "client/library/client_call.h"
#include "client/library/raw_call.h"
#include "core/base/posix/file.h"
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
  PieceReader(File file, std::uint64_t offset) : input_(std::move(file)), offset_(offset) {}

  /// The next piece as an UploadGridRequest; of nothing at the end of the file. Errors: those
  /// of io_error.
  absl::StatusOr<grpc::ByteBuffer> next() {
    const grpc::Slice block = blocks_.take(FieldWriter::kCapacity + kUploadPieceBytes);
    auto* const bytes = reinterpret_cast<char*>(const_cast<std::uint8_t*>(block.begin()));
    auto* const piece = bytes + FieldWriter::kCapacity;
    const auto count = input_.read_at(offset_, {piece, kUploadPieceBytes});
    if (!count.ok()) return count.status();
    size_ = *count;
    const FieldWriter prefix = upload_prefix(offset_, size_);
    prefix.copy_before(reinterpret_cast<std::byte*>(piece));
    offset_ += size_;
    const grpc::Slice message =
        block.sub(FieldWriter::kCapacity - prefix.size(), FieldWriter::kCapacity + size_);
    return grpc::ByteBuffer(&message, 1);
  }

  /// Bytes of the file in the last piece, and where it ended.
  std::size_t piece_bytes() const { return size_; }
  std::uint64_t offset() const { return offset_; }

 private:
  // One is being sent, one is in the transport's hands, and one is read.
  static constexpr std::size_t kBlocks = 3;

  BlockPool blocks_{FieldWriter::kCapacity + kUploadPieceBytes, kBlocks};
  File input_;
  std::uint64_t offset_;
  std::size_t size_ = 0;
};

/// Writes what the server lacks, until it stops listening. Errors: those of reading the file.
absl::Status write_pieces(RawCall& call,
                          const LocalFile& file,
                          std::uint64_t offset,
                          const ClientProgress& progress) {
  absl::StatusOr<File> opened = File::open(file.path, O_RDONLY, io_error);
  if (!opened.ok()) return opened.status();
  v1::UploadGridRequest start;
  start.mutable_start()->set_name(file.name);
  start.mutable_start()->set_size_bytes(static_cast<std::int64_t>(file.size_bytes));
  if (!call.write(serialized(start))) return absl::OkStatus();
  for (PieceReader reader(*std::move(opened), offset); reader.offset() < file.size_bytes;) {
    const absl::StatusOr<grpc::ByteBuffer> piece = reader.next();
    if (!piece.ok()) return piece.status();
    if (reader.piece_bytes() == 0) break;  // the file shrank: the server will miss the rest
    if (!call.write(*piece)) return absl::OkStatus();
    if (progress.upload) progress.upload(reader.offset(), file.size_bytes);
  }
  call.writes_done();
  return absl::OkStatus();
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
  if (absl::Status unread = write_pieces(call, file, offset, progress); !unread.ok()) {
    attempt.context().TryCancel();
    call.finish();
    return unread;
  }
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
