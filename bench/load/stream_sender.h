// Requests to a real server.
#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "bench/load/request_sender.h"
#include "client/library/channel.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

namespace v1 = ::tetstream::v1;

struct StreamSettings {
  std::string address;
  ChannelOptions channel;                      ///< how that is spoken to
  int connections = 8;                         ///< requests go to them in turn
  v1::Encoding encoding = v1::ENCODING_PLAIN;  ///< that streams are asked for in
  bool check_columns = false;                  ///< verify the checksum of every chunk
  /// Until all connections are open: for a server that is busy. One that is not there was
  /// missed before, when the mix was looked at.
  Nanoseconds patience{std::chrono::seconds(60)};
};

/// Sends StreamMesh calls and drops what comes. Calls are asynchronous: gRPC's own few threads
/// read all streams, so that thousands may be under way without a thread each. A stream whose
/// chunks are not whole and in order ends with kDataLoss.
///
/// Waits for all connections, so that no request pays for opening one.
/// Errors: those of open_channel, kUnavailable (no connection).
absl::StatusOr<std::unique_ptr<RequestSender>> open_stream_sender(
    const StreamSettings& settings);

}  // namespace tet::load
