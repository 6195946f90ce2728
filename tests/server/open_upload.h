// An upload step by step: what its client sends, and when, is up to a test.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "proto/wire/sha256.h"
#include "tetstream/v1/grids.grpc.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

/// What a file of this content is stored as.
inline std::string grid_name_of(std::string_view content) {
  Sha256 digest;
  digest.add(content);
  return name_of_grid(digest.finish_hex());
}

class OpenUpload {
 public:
  /// Announces `size` bytes.
  OpenUpload(v1::GridService::Stub& grids,
             const std::string& name,
             std::size_t size,
             const std::string& token = "") {
    if (!token.empty()) context_.AddMetadata("authorization", "Bearer " + token);
    writer_ = grids.UploadGrid(&context_, &response_);
    v1::UploadGridRequest message;
    message.mutable_start()->set_name(name);
    message.mutable_start()->set_size_bytes(static_cast<std::int64_t>(size));
    writer_->Write(message);
  }
  OpenUpload(const OpenUpload&) = delete;
  OpenUpload& operator=(const OpenUpload&) = delete;

  void send(const std::string& bytes, std::int64_t offset = 0) {
    v1::UploadGridRequest message;
    message.mutable_data()->set_offset(offset);
    message.mutable_data()->set_data(bytes);
    writer_->Write(message);
  }

  /// Sends nothing more, and waits for the answer.
  grpc::Status finish() {
    writer_->WritesDone();
    return wait();
  }

  /// Waits for the answer, without saying that nothing more will come.
  grpc::Status wait() { return writer_->Finish(); }

  grpc::Status cancel() {
    context_.TryCancel();
    return wait();
  }

  /// Once there is an answer.
  const v1::UploadGridResponse& response() const { return response_; }

 private:
  grpc::ClientContext context_;
  v1::UploadGridResponse response_;
  std::unique_ptr<grpc::ClientWriter<v1::UploadGridRequest>> writer_;
};

/// How an upload ended.
struct UploadOutcome {
  grpc::Status status;
  v1::UploadGridResponse response;
};

/// Announces `size` bytes, sends `text` from `offset` on in one message, and ends the stream.
inline UploadOutcome upload_text(v1::GridService::Stub& grids,
                                 const std::string& name,
                                 const std::string& text,
                                 std::size_t size,
                                 std::int64_t offset = 0) {
  OpenUpload upload(grids, name, size);
  upload.send(text, offset);
  grpc::Status status = upload.finish();
  return {std::move(status), upload.response()};
}

}  // namespace tet::test
