// One connection: requests in, answers out, in turn, and never longer than anyone may take.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <absl/strings/string_view.h>

#include "server/http/exchange.h"
#include "server/http/http_socket.h"
#include "server/http/progress.h"
#include "server/http/request_head.h"

namespace tet {

/// What one connection may take.
struct HttpLimits {
  HeadLimits head;
  std::size_t body_bytes = 4 << 20;       ///< of a request that is read as a whole
  std::size_t buffered_bytes = 64 << 20;  ///< of all connections' requests together
  std::chrono::seconds head_time{10};   ///< from its first byte, or the handshake's, to its end
  std::chrono::seconds idle_time{60};   ///< between requests
  std::chrono::seconds stall_time{60};  ///< to send a body, and to take anything of an answer
};

class HttpConnection;

/// What the connections of a port have in common.
struct HttpShared {
  HttpPlace& place;
  HttpLimits limits;
  std::function<void(int status)> refused;     ///< counts
  std::function<void(int descriptor)> closed;  ///< forgets the connection
  /// Closes another connection that has bytes buffered and gets nowhere; false where none
  /// does.
  std::function<bool(const HttpConnection&)> make_room;
  std::size_t buffered = 0;  ///< bytes of requests in all connections
  /// What one connection has just received. A buffer of each connection's own would be memory
  /// that nobody counts, held by a few bytes that are in it.
  std::vector<char> received = std::vector<char>(64 << 10);
};

/// All on the loop's thread.
class HttpConnection final : public AnswerStream,
                             public std::enable_shared_from_this<HttpConnection> {
 public:
  using Clock = Progress::Clock;

  HttpConnection(HttpShared& shared, HttpSocket socket);
  ~HttpConnection() override;

  /// Begins to wait for the first request.
  void open();
  void close();
  /// Closes it where it took too long over something.
  void check(Clock::time_point now);
  /// Since when it has kept us waiting for a request, or to close after its last one; none
  /// while it is being served.
  std::optional<Clock::time_point> waiting_since() const;
  /// Since when it has moved less than a stride of a request or an answer; none while we are
  /// the ones who have something to do.
  std::optional<Clock::time_point> slow_since() const;

  /// Whether it has sent what was not used yet.
  bool has_buffered() const { return !in_.empty(); }
  /// Whether an answer is on its way.
  bool is_sending() const { return queued_ > 0; }

  const ForwardedPeer& peer() const override { return socket_.peer(); }
  void send(HttpAnswer answer) override;
  void begin(int status, absl::string_view type, HttpHeaders headers) override;
  void send_piece(std::vector<grpc::Slice> piece) override;
  void end() override;
  bool has_room() const override;
  void want_body() override;

 private:
  enum class State {
    kHandshake,
    kIdle,
    kHead,
    kBody,
    kPieces,
    kAnswering,
    kLingering,
    kClosed
  };
  struct Outgoing {
    grpc::Slice slice;
    std::size_t done = 0;
  };

  void happened(std::uint32_t events);
  void enter(State state, std::optional<std::chrono::seconds> patience);
  void watch();
  bool wants_input() const;
  template <class Function>
  void or_close(const Function& work);
  void receive();
  void receive_some();
  void receive_later();
  void drop_input();
  bool account();
  void process();
  bool step();
  bool read_head();
  void accept_head(RequestHead head);
  bool read_body();
  bool read_piece();
  void promise_body();
  void refuse(const HttpRefusal& refusal);
  void queue(grpc::Slice slice);
  void flush();
  bool flush_some();
  void answered();

  HttpShared& shared_;
  HttpSocket socket_;
  State state_ = State::kHandshake;
  Clock::time_point since_ = Clock::now();     ///< when it came into that state
  std::optional<Clock::time_point> deadline_;  ///< of the state
  std::string in_;                             ///< received, and not used
  std::size_t accounted_ = 0;                  ///< of it, in HttpShared::buffered
  RequestHead head_;
  std::uint64_t body_left_ = 0;
  std::shared_ptr<Exchange> exchange_;
  bool wants_piece_ = false, piecewise_ = false, keep_alive_ = true, ended_ = false;
  bool processing_ = false, receives_later_ = false;
  int heads_ = 0;  ///< that were begun in this turn
  std::deque<Outgoing> out_;
  std::size_t queued_ = 0;              ///< bytes in it
  Clock::time_point last_taken_;        ///< when the socket last took something
  Progress progress_;                   ///< of what is received and sent
  std::uint32_t handshake_events_ = 0;  ///< what TLS waits for
  std::uint32_t watched_ = 0;
};

}  // namespace tet
