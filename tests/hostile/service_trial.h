// One file through all of a server: uploaded, looked into, meshed.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <grpcpp/channel.h>

#include "tests/support/eventually.h"
#include "tetstream/v1/grids.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

/// A client with a connection of its own. Not thread-safe.
class ServiceTrial {
 public:
  explicit ServiceTrial(const std::string& address,
                        std::chrono::seconds patience = kGenerousEnd);

  /// The first failure of the three calls; ok when a whole mesh came. Its grids' values were
  /// asked for, too, at the vertices of a ball: what that was refused with is told only if no
  /// file should be. kDeadlineExceeded when a call took longer than the client's patience, or a
  /// decoder than its limit.
  absl::Status run(std::string_view file);

 private:
  grpc::Status upload(const std::string& name, std::string_view file);
  grpc::Status look_into(const std::string& name, v1::GridFile& file);
  grpc::Status mesh(const v1::MeshRequest& mesh);
  grpc::Status sample(const v1::GridFile& file);

  std::chrono::seconds patience_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::GridService::Stub> grids_;
  std::unique_ptr<v1::MeshService::Stub> meshes_;
};

}  // namespace tet::test
