#include "server/upload_stream.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "server/request.h"
#include "server/status.h"

namespace tet {

namespace {

absl::Status out_of_order(const char* message) {
  return with_reason(absl::InvalidArgumentError(message), "MESSAGE_ORDER");
}

}  // namespace

UploadStream::UploadStream(GridStore& store,
                           CallRegistry& calls,
                           TaskPool& disk,
                           const grpc::CallbackServerContext& context,
                           v1::UploadGridResponse& response)
    : store_(store), disk_(disk), call_(calls, context, "UploadGrid"), response_(response) {
  const absl::Status admitted = calls.admission();
  if (admitted.ok()) {
    StartRead(&message_);
  } else {
    finish(admitted);
  }
}

void UploadStream::OnReadDone(bool ok) {
  if (ok) return disk_.post([this] { take_message(); });
  // The stream ended, by the client's will or not: what has come is kept either way.
  finish(response_.name().empty() ? out_of_order("the stream ended before `start`")
                                  : absl::OkStatus());
}

void UploadStream::take_message() {
  absl::Status status = out_of_order("a message with neither `start` nor `data`");
  if (message_.has_start()) status = take_start(message_.start());
  if (message_.has_data()) status = take_data(message_.data());
  if (!status.ok() || response_.complete()) return finish(status);
  StartRead(&message_);
}

absl::Status UploadStream::take_start(const v1::UploadStart& start) {
  if (upload_ != nullptr) return out_of_order("a second `start`");
  const auto digest = parse_grid_name(start.name());
  if (!digest.ok()) return digest.status();
  if (start.size_bytes() < 1) {
    return invalid_field(absl::StrCat("size_bytes ", start.size_bytes(), " is not positive"));
  }
  auto upload = store_.begin_upload(*digest, static_cast<std::uint64_t>(start.size_bytes()));
  if (!upload.ok() && !absl::IsAlreadyExists(upload.status())) return upload.status();
  response_.set_name(start.name());
  if (!upload.ok()) {
    const UploadState state = store_.upload_state(*digest);
    response_.set_complete(store_.touch(*digest));
    response_.set_committed_size(static_cast<std::int64_t>(state.committed_size));
    return absl::OkStatus();
  }
  upload_ = *std::move(upload);
  response_.set_committed_size(static_cast<std::int64_t>(upload_->committed_size()));
  // All bytes may have come before a restart, without the commit.
  return upload_->has_all() ? take_data({}) : absl::OkStatus();
}

absl::Status UploadStream::take_data(const v1::UploadData& data) {
  if (upload_ == nullptr) return out_of_order("`data` before `start`");
  if (!upload_->has_all() || !data.data().empty()) {
    const auto offset = static_cast<std::uint64_t>(data.offset());
    const absl::Status appended = upload_->append(offset, data.data());
    if (!appended.ok()) return appended;
  }
  response_.set_committed_size(static_cast<std::int64_t>(upload_->committed_size()));
  if (!upload_->has_all()) return absl::OkStatus();
  const absl::Status committed = upload_->commit();
  response_.set_complete(committed.ok());
  return committed;
}

void UploadStream::finish(const absl::Status& status) {
  upload_.reset();  // whoever sees the answer may go on with the upload at once
  call_.note("bytes", response_.committed_size());
  Finish(call_.finish(status));
}

}  // namespace tet
