#include "tests/hostile/service_trial.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "proto/wire/sha256.h"

namespace tet::test {

namespace {

constexpr std::chrono::milliseconds kPause{20};
constexpr std::size_t kPieceBytes = std::size_t{512} << 10;

struct Call {
  explicit Call(std::chrono::seconds patience) {
    context.set_deadline(std::chrono::system_clock::now() + patience);
  }
  grpc::ClientContext context;
};

/// Whether a decoder was ended over the file, by the clock or by its processor time.
bool took_too_long(const grpc::Status& status) {
  return status.error_details().find("DECODER_TIMEOUT") != std::string::npos;
}

absl::Status to_absl(const grpc::Status& status) {
  if (took_too_long(status)) return absl::DeadlineExceededError(status.error_message());
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

bool is_refusal(const grpc::Status& status) {
  if (took_too_long(status)) return false;
  return status.error_code() == grpc::StatusCode::INVALID_ARGUMENT ||
         status.error_code() == grpc::StatusCode::FAILED_PRECONDITION ||
         status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED;
}

std::shared_ptr<grpc::Channel> connect(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // as another client would
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

ServiceTrial::ServiceTrial(const std::string& address, std::chrono::seconds patience)
    : patience_(patience),
      channel_(connect(address)),
      grids_(v1::GridService::NewStub(channel_)),
      meshes_(v1::MeshService::NewStub(channel_)) {}

absl::Status ServiceTrial::run(std::string_view file) {
  Sha256 digest;
  digest.add(file);
  const std::string name = name_of_grid(digest.finish_hex());
  grpc::Status uploaded = upload(name, file);
  // When two clients bring the same bytes at the same time, one is told to try again.
  const auto give_up = std::chrono::steady_clock::now() + patience_;
  while (uploaded.error_code() == grpc::StatusCode::ABORTED &&
         std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(kPause);
    uploaded = upload(name, file);
  }
  if (!uploaded.ok()) return to_absl(uploaded);
  v1::GridFile seen_file;
  const grpc::Status seen = look_into(name, seen_file);
  v1::MeshRequest request;
  request.set_name(name);
  const grpc::Status meshed = mesh(request);
  const grpc::Status sampled = sample(seen_file);
  if (!sampled.ok() && !is_refusal(sampled)) return to_absl(sampled);
  return to_absl(seen.ok() ? meshed : seen);
}

grpc::Status ServiceTrial::upload(const std::string& name, std::string_view file) {
  Call call(patience_);
  v1::UploadGridResponse response;
  const auto writer = grids_->UploadGrid(&call.context, &response);
  v1::UploadGridRequest message;
  message.mutable_start()->set_name(name);
  message.mutable_start()->set_size_bytes(static_cast<std::int64_t>(file.size()));
  bool open = writer->Write(message);
  for (std::size_t at = 0; open && at < file.size(); at += kPieceBytes) {
    message.mutable_data()->set_offset(static_cast<std::int64_t>(at));
    message.mutable_data()->set_data(std::string(file.substr(at, kPieceBytes)));
    open = writer->Write(message);
  }
  writer->WritesDone();
  return writer->Finish();
}

grpc::Status ServiceTrial::look_into(const std::string& name, v1::GridFile& file) {
  Call call(patience_);
  v1::GetGridInfoRequest request;
  request.set_name(name);
  return grids_->GetGridInfo(&call.context, request, &file);
}

grpc::Status ServiceTrial::mesh(const v1::MeshRequest& mesh) {
  Call call(patience_);
  v1::StreamMeshRequest request;
  *request.mutable_mesh() = mesh;
  const auto reader = meshes_->StreamMesh(&call.context, request);
  v1::MeshEvent event;
  while (reader->Read(&event)) {
  }
  return reader->Finish();
}

/// One after the other, so that each is read whatever the others are.
grpc::Status ServiceTrial::sample(const v1::GridFile& file) {
  constexpr int kMostGrids = 3;
  grpc::Status worst;
  for (int i = 0; i < std::min(file.grids_size(), kMostGrids); ++i) {
    if (file.grids(i).field_components() == 0) continue;
    v1::MeshRequest ball;
    ball.set_spacing(0.5);
    ball.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(2);
    v1::Field& field = *ball.add_fields();
    field.set_name("values");
    field.set_grid(file.name());
    field.set_grid_name(file.grids(i).name());
    const grpc::Status sampled = mesh(ball);
    if (worst.ok() || is_refusal(worst)) worst = sampled;
  }
  return worst;
}

}  // namespace tet::test
