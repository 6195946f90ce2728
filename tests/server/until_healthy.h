// Calls to a server whose disk is slow to answer.
#pragma once

#include <string>

#include <grpcpp/support/status.h>

#include "tests/server/reason_of.h"
#include "tests/support/eventually.h"

namespace tet::test {

/// How a call ends that is made again while the server refuses it because what keeps its jobs
/// has not answered for seconds: a busy disk takes as long now and then, whatever is claimed.
template <class Call>
grpc::Status asked_until_healthy(const Call& call) {
  grpc::Status status;
  eventually([&] {
    status = call();
    if (status.error_code() != grpc::StatusCode::UNAVAILABLE) return true;
    const std::string reason = reason_of(status);
    return reason != "tetstream/NO_ANSWER" && reason != "tetstream/JOB_STORE_UNAVAILABLE";
  });
  return status;
}

}  // namespace tet::test
