// One request under way: a stream, or a job that is made, waited for and read.
#pragma once

#include <memory>

#include <grpcpp/generic/generic_stub.h>

#include "bench/load/call_book.h"
#include "bench/load/request_sender.h"
#include "client/library/channel.h"
#include "tetstream/v1/jobs.grpc.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

namespace v1 = ::tetstream::v1;

/// A connection, and what is asked over it.
struct LoadServer {
  explicit LoadServer(ServerChannel opened) : channel(std::move(opened)) {}

  const ServerChannel channel;
  grpc::GenericStub streams{channel.channel()};
  tetstream::v1::JobService::Stub jobs{channel.channel()};
};

struct CallSettings {
  v1::Encoding encoding = v1::ENCODING_PLAIN;  ///< jobs have none other
  bool check_columns = false;                  ///< verify the checksum of every chunk
};

/// Begins and returns; `done` is called once, on another thread. All outlive the call.
void begin_call(LoadServer& server,
                CallBook& book,
                const CallSettings& settings,
                const LoadRequest& request,
                RequestSender::Done done);

}  // namespace tet::load
