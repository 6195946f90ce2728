// One request and its answer, between a connection and what the request asks for.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <absl/strings/string_view.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/slice.h>

#include "server/http/event_loop.h"
#include "server/http/http_answer.h"
#include "server/http/http_gate.h"
#include "server/http/page_files.h"
#include "server/http/request_head.h"
#include "server/ops/metric_history.h"
#include "server/rpc/forwarded.h"

namespace tet {

/// What all requests share; outlives them.
struct HttpPlace {
  EventLoop& loop;
  HttpGate gate;
  PageFiles page;
  grpc::Slice open_api;
  grpc::Slice grpc_place;  ///< JSON: see grpc_place_json
  std::shared_ptr<grpc::GenericStub> stub;
  std::function<std::string()> metrics;
  /// JSON, of the families of metrics whose names it is given: see MetricHistory.
  std::function<MetricHistory::Telling(absl::string_view)> history;
  std::function<bool()> ready;
  bool needs_token = false;
};

/// Where an answer is written; all on the loop's thread.
class AnswerStream {
 public:
  virtual ~AnswerStream() = default;
  virtual const ForwardedPeer& peer() const = 0;
  /// Sends a whole answer.
  virtual void send(HttpAnswer answer) = 0;
  /// Begins one whose length nobody knows: pieces follow, then the end.
  virtual void begin(int status, absl::string_view type, HttpHeaders headers) = 0;
  virtual void send_piece(std::vector<grpc::Slice> piece) = 0;
  virtual void end() = 0;
  /// Whether pieces would be on their way soon; where not, `on_room` tells when.
  virtual bool has_room() const = 0;
  /// Asks for more of the body; `on_body` brings it.
  virtual void want_body() = 0;
};

/// Answers one request. All on the loop's thread.
class Exchange {
 public:
  virtual ~Exchange() = default;
  virtual void start(std::string body) = 0;
  /// The next bytes of a body that is read piece by piece; `last` where nothing is left.
  // By value, as whoever wants the pieces keeps them.
  // NOLINTNEXTLINE(performance-unnecessary-value-param)
  virtual void on_body(std::string /*piece*/, bool /*last*/) {}
  virtual void on_room() {}
  /// Whoever asked has gone.
  virtual void abandon() = 0;
  /// Whether the body is wanted piece by piece, and not as a whole with `start`.
  virtual bool takes_pieces() const { return false; }
};

/// Returns what answers the request, or why nothing does. The connection has the body read
/// where the head announces one.
std::variant<std::shared_ptr<Exchange>, HttpRefusal> make_exchange(const HttpPlace& place,
                                                                   const RequestHead& head,
                                                                   AnswerStream& stream);

}  // namespace tet
