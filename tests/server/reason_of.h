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

/// The field that its BadRequest names; empty without one.
inline std::string field_of(const grpc::Status& status) {
  google::rpc::Status rpc;
  google::rpc::BadRequest bad;
  if (!rpc.ParseFromString(status.error_details())) return "no details";
  for (const auto& detail : rpc.details()) detail.UnpackTo(&bad);
  return bad.field_violations().empty() ? "" : bad.field_violations(0).field();
}

}  // namespace tet::test
