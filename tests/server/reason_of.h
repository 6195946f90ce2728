// What a failure says of itself to programs.
#pragma once

#include <string>

#include <grpcpp/support/status.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace tet::test {

/// "domain/reason" of its ErrorInfo.
inline std::string reason_of(const grpc::Status& status) {
  google::rpc::Status rpc;
  google::rpc::ErrorInfo info;
  if (!rpc.ParseFromString(status.error_details())) return "no details";
  for (const auto& detail : rpc.details()) detail.UnpackTo(&info);
  return info.domain() + "/" + info.reason();
}

}  // namespace tet::test
