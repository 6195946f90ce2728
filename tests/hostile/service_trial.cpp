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

absl::Status to_absl(const grpc::Status& status) {
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
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
  // Of two clients that bring the same bytes at the same time one is told to try again.
  const auto give_up = std::chrono::steady_clock::now() + patience_;
  while (uploaded.error_code() == grpc::StatusCode::ABORTED &&
         std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(kPause);
    uploaded = upload(name, file);
  }
  if (!uploaded.ok()) return to_absl(uploaded);
  const grpc::Status seen = look_into(name);
  const grpc::Status meshed = mesh(name);
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

grpc::Status ServiceTrial::look_into(const std::string& name) {
  Call call(patience_);
  v1::GetGridInfoRequest request;
  request.set_name(name);
  v1::GridFile response;
  return grids_->GetGridInfo(&call.context, request, &response);
}

grpc::Status ServiceTrial::mesh(const std::string& name) {
  Call call(patience_);
  v1::StreamMeshRequest request;
  request.mutable_mesh()->set_name(name);
  const auto reader = meshes_->StreamMesh(&call.context, request);
  v1::MeshEvent event;
  while (reader->Read(&event)) {
  }
  return reader->Finish();
}

}  // namespace tet::test
