#include "server/http/http_connection.h"

#include <algorithm>
#include <sys/epoll.h>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/string_view.h>

namespace tet {

namespace {

constexpr std::size_t kPieceBytes = 512 << 10;
// What one connection is read of in its turn, in buffers: who sends as fast as we read would
// keep the thread from all others.
constexpr int kMostReads = 16;
// And how many requests it is answered in its turn: a buffer holds two thousand that ask for
// something larger than themselves.
constexpr int kMostHeads = 8;
// Two chunks of a mesh on their way hide what making the next one takes.
constexpr std::size_t kRoomBytes = 512 << 10;
// What anyone may send though others have filled the room of all: a question, as no body is.
constexpr std::size_t kQuestionBytes = 4 << 10;
// So that the other side reads our answer, and not that its bytes had nobody to read them.
constexpr std::chrono::seconds kLinger{2};
constexpr std::uint32_t kGone = EPOLLERR | EPOLLHUP;

}  // namespace

HttpConnection::HttpConnection(HttpShared& shared, HttpSocket socket)
    : shared_(shared), socket_(std::move(socket)) {}

HttpConnection::~HttpConnection() { shared_.buffered -= accounted_; }

void HttpConnection::open() {
  watched_ = EPOLLIN;
  shared_.place.loop.watch(socket_.number(), watched_,
                           [this](std::uint32_t events) { happened(events); });
  enter(State::kHandshake, shared_.limits.head_time);
  happened(0);
}

void HttpConnection::close() {
  if (std::exchange(state_, State::kClosed) == State::kClosed) return;
  const auto self = shared_from_this();
  if (exchange_ != nullptr) exchange_->abandon();
  shared_.place.loop.forget(socket_.number());
  shared_.closed(socket_.number());
  drop_input();
  // Whoever called may be one of ours.
  shared_.place.loop.post([self, exchange = std::move(exchange_)] {});
}

std::optional<HttpConnection::Clock::time_point> HttpConnection::waiting_since() const {
  const bool waiting = state_ == State::kHandshake || state_ == State::kIdle ||
                       state_ == State::kHead || state_ == State::kLingering;
  return waiting ? std::optional(since_) : std::nullopt;
}

std::optional<HttpConnection::Clock::time_point> HttpConnection::slow_since() const {
  const bool moves = queued_ > 0 || state_ == State::kHead || state_ == State::kBody ||
                     (state_ == State::kPieces && wants_piece_);
  return moves ? std::optional(progress_.since()) : std::nullopt;
}

void HttpConnection::check(Clock::time_point now) {
  // The socket has room again, and takes more, when the other side has taken a third of what
  // was in it: of a slow reader that tells too late.
  if (progress_.is_taking()) progress_.looked(socket_.unacknowledged(), now);
  const bool stalled = queued_ > 0 && now > last_taken_ + shared_.limits.stall_time;
  const bool late = deadline_ && now > *deadline_;
  if (!stalled && !late) return;
  if (!stalled && (state_ == State::kHead || state_ == State::kBody)) {
    return refuse({408, "the request did not come in time"});
  }
  close();
}

void HttpConnection::enter(State state, std::optional<std::chrono::seconds> patience) {
  state_ = state;
  since_ = Clock::now();
  progress_.begin(since_);
  deadline_.reset();
  if (patience) deadline_ = since_ + *patience;
}

bool HttpConnection::wants_input() const {
  switch (state_) {
    case State::kIdle:
    case State::kHead:
    case State::kBody:
    case State::kLingering:
      return true;
    case State::kPieces:
      return wants_piece_;
    default:
      return false;
  }
}

void HttpConnection::watch() {
  if (state_ == State::kClosed) return;
  std::uint32_t events = wants_input() ? EPOLLIN : EPOLLRDHUP;
  if (state_ == State::kHandshake) events = handshake_events_;
  if (!out_.empty()) events |= EPOLLOUT;
  if (events != std::exchange(watched_, events)) {
    shared_.place.loop.change(socket_.number(), events);
  }
}

void HttpConnection::happened(std::uint32_t events) {
  const auto self = shared_from_this();
  const bool left = (events & EPOLLRDHUP) != 0 && !wants_input();
  if ((events & kGone) != 0 || left) return close();
  if (state_ == State::kHandshake) {
    const Io shaken = socket_.handshake();
    if (shaken == Io::kClosed) return close();
    handshake_events_ = shaken == Io::kWaitWrite ? EPOLLOUT : EPOLLIN;
    if (shaken == Io::kDone) enter(State::kIdle, shared_.limits.head_time);
  }
  if ((events & EPOLLOUT) != 0) flush();
  if (wants_input()) receive();
  watch();
}

/// What throws leaves half a step behind, or bytes that are nowhere: nobody could go on there.
template <class Function>
void HttpConnection::or_close(const Function& work) {
  try {
    work();
  } catch (...) {
    close();
    throw;
  }
}

void HttpConnection::receive() {
  or_close([this] { receive_some(); });
}

void HttpConnection::receive_some() {
  for (int reads = 0; wants_input() && !receives_later_; ++reads) {
    if (reads == kMostReads) return receive_later();
    std::size_t got = 0;
    const Io io = socket_.read(shared_.received, got);
    if (io == Io::kClosed) return close();
    if (io != Io::kDone) return;
    if (state_ == State::kLingering) continue;
    progress_.moved(got, Clock::now());
    in_.append(shared_.received.data(), got);
    while (!account()) {
      if (in_.size() <= kQuestionBytes) break;
      if (shared_.make_room(*this)) continue;
      return refuse({503, "too many requests are being received: try again"});
    }
    process();
  }
}

/// Lets others have their turns before more is read or answered. No event tells of what we, or
/// TLS, have read already.
void HttpConnection::receive_later() {
  if (std::exchange(receives_later_, true)) return;
  shared_.place.loop.post([self = shared_from_this()] {
    self->receives_later_ = false;
    self->process();
    self->receive();
    self->watch();
  });
}

/// Drops what has come and nobody will read.
void HttpConnection::drop_input() {
  in_.clear();
  in_.shrink_to_fit();
  account();
}

/// Counts what is buffered for this connection; false where that is too much for all of them.
bool HttpConnection::account() {
  shared_.buffered += in_.size() - accounted_;
  accounted_ = in_.size();
  return shared_.buffered <= shared_.limits.buffered_bytes;
}

void HttpConnection::process() {
  if (receives_later_ || std::exchange(processing_, true)) return;
  heads_ = 0;
  or_close([this] {
    while (step()) {
    }
  });
  processing_ = false;
  // What is counted is what has come, and never less than half of the memory.
  if (in_.capacity() > 2 * in_.size()) in_.shrink_to_fit();
  account();
}

/// Does the next thing that what has come allows; false where there is none.
bool HttpConnection::step() {
  switch (state_) {
    case State::kIdle:
      if (in_.empty()) return false;
      if (heads_++ == kMostHeads) {
        receive_later();
        return false;
      }
      enter(State::kHead, shared_.limits.head_time);
      return true;
    case State::kHead:
      return read_head();
    case State::kBody:
      return read_body();
    case State::kPieces:
      return read_piece();
    default:
      return false;
  }
}

bool HttpConnection::read_head() {
  const std::size_t limit = shared_.limits.head.bytes;
  const auto size = head_size(absl::string_view(in_).substr(0, limit + 1));
  if (!size && in_.size() <= limit) return false;
  auto parsed =
      size ? parse_head(absl::string_view(in_).substr(0, *size), shared_.limits.head)
           : HttpRefusal{431, absl::StrCat("the head has more than ", limit, " bytes")};
  if (auto* refusal = std::get_if<HttpRefusal>(&parsed)) {
    refuse(*refusal);
    return false;
  }
  in_.erase(0, *size);
  accept_head(std::get<RequestHead>(std::move(parsed)));
  return true;
}

void HttpConnection::accept_head(RequestHead head) {
  head_ = std::move(head);
  keep_alive_ = head_.keep_alive;
  body_left_ = head_.content_length.value_or(0);
  ended_ = piecewise_ = wants_piece_ = false;
  if (const auto refusal = shared_.place.gate.check(head_)) return refuse(*refusal);
  auto made = make_exchange(shared_.place, head_, *this);
  if (const auto* refusal = std::get_if<HttpRefusal>(&made)) return refuse(*refusal);
  auto exchange = std::get<std::shared_ptr<Exchange>>(std::move(made));
  if (!exchange->takes_pieces() && body_left_ > shared_.limits.body_bytes) {
    return refuse({413, absl::StrCat("a body of ", body_left_, " bytes, and ",
                                     shared_.limits.body_bytes, " are the most")});
  }
  exchange_ = std::move(exchange);
  if (exchange_->takes_pieces()) {
    piecewise_ = true;
    enter(State::kPieces, std::nullopt);
    exchange_->start({});
    return;
  }
  enter(State::kBody, shared_.limits.stall_time);
  if (body_left_ > 0) promise_body();
}

void HttpConnection::promise_body() {
  if (std::exchange(head_.expects_continue, false)) {
    queue(grpc::Slice("HTTP/1.1 100 Continue\r\n\r\n"));
    flush();
  }
}

bool HttpConnection::read_body() {
  if (in_.size() < body_left_) return false;
  std::string body = in_.substr(0, body_left_);
  in_.erase(0, body_left_);
  body_left_ = 0;
  enter(State::kAnswering, std::nullopt);
  const auto exchange = exchange_;
  exchange->start(std::move(body));
  return true;
}

void HttpConnection::want_body() {
  wants_piece_ = true;
  progress_.begin(Clock::now());
  promise_body();
  receive();  // TLS may have bytes that no event tells of
  process();
  watch();
}

bool HttpConnection::read_piece() {
  const auto size = std::min<std::uint64_t>(body_left_, kPieceBytes);
  if (!wants_piece_ || in_.size() < size) return false;
  wants_piece_ = false;
  std::string piece = in_.substr(0, size);
  in_.erase(0, size);
  body_left_ -= size;
  if (body_left_ == 0) enter(State::kAnswering, std::nullopt);
  exchange_->on_body(std::move(piece), body_left_ == 0);
  return true;
}

void HttpConnection::refuse(const HttpRefusal& refusal) {
  shared_.refused(refusal.status);
  keep_alive_ = false;
  drop_input();
  if (exchange_ != nullptr) exchange_->abandon();
  send(refusal_answer(refusal));
}

void HttpConnection::send(HttpAnswer answer) {
  if (state_ == State::kClosed) return;
  if (body_left_ > 0) keep_alive_ = false;  // nobody will read the rest
  const bool cut = head_.method == "HEAD";
  HttpHeaders headers = shared_.place.gate.headers_for(head_);
  headers.insert(headers.end(), answer.headers.begin(), answer.headers.end());
  enter(State::kAnswering, std::nullopt);
  const grpc::Slice body = answer.body.empty() ? answer.kept : grpc::Slice(answer.body);
  queue(grpc::Slice(answer_head(answer.status, answer.type, absl::StrCat(body.size()),
                                keep_alive_, headers)));
  if (!cut && body.size() > 0) queue(body);
  ended_ = true;
  flush();
}

void HttpConnection::begin(int status, absl::string_view type, HttpHeaders headers) {
  if (state_ == State::kClosed) return;
  const HttpHeaders shared = shared_.place.gate.headers_for(head_);
  headers.insert(headers.end(), shared.begin(), shared.end());
  queue(grpc::Slice(answer_head(status, type, kChunked, keep_alive_, headers)));
}

void HttpConnection::send_piece(std::vector<grpc::Slice> piece) {
  if (state_ == State::kClosed) return;
  std::size_t bytes = 0;
  for (const grpc::Slice& slice : piece) bytes += slice.size();
  if (bytes == 0) return;  // would be the end
  queue(grpc::Slice(absl::StrFormat("%x\r\n", bytes)));
  for (grpc::Slice& slice : piece) queue(std::move(slice));
  queue(grpc::Slice("\r\n"));
  flush();
}

void HttpConnection::end() {
  if (state_ == State::kClosed) return;
  queue(grpc::Slice("0\r\n\r\n"));
  ended_ = true;
  flush();
}

bool HttpConnection::has_room() const { return queued_ < kRoomBytes; }

void HttpConnection::queue(grpc::Slice slice) {
  if (out_.empty()) {
    last_taken_ = Clock::now();
    progress_.begin(last_taken_);
  }
  queued_ += slice.size();
  out_.push_back({std::move(slice), 0});
}

/// Sends what the other side takes; false where the connection broke.
bool HttpConnection::flush_some() {
  while (!out_.empty()) {
    Outgoing& first = out_.front();
    const absl::string_view bytes(reinterpret_cast<const char*>(first.slice.begin()),
                                  first.slice.size());
    std::size_t written = 0;
    const Io io = socket_.write(bytes.substr(first.done), out_.size() > 1, written);
    if (io == Io::kClosed) return false;
    if (io != Io::kDone) return true;
    last_taken_ = Clock::now();
    progress_.gave(written);
    queued_ -= written;
    first.done += written;
    if (first.done == bytes.size()) out_.pop_front();
  }
  return true;
}

void HttpConnection::flush() {
  if (state_ == State::kClosed) return;
  const auto self = shared_from_this();
  if (!flush_some()) return close();
  if (out_.empty() && std::exchange(ended_, false)) return answered();
  if (exchange_ != nullptr && has_room()) exchange_->on_room();
  watch();
}

void HttpConnection::answered() {
  // It may be what called.
  shared_.place.loop.post([exchange = std::move(exchange_)] {});
  exchange_ = nullptr;
  head_ = {};
  if (!keep_alive_) {
    drop_input();
    socket_.end_writing();
    enter(State::kLingering, kLinger);
  } else {
    enter(State::kIdle, shared_.limits.idle_time);
    process();
    if (!processing_) receive();  // TLS may have bytes that no event tells of
  }
  watch();
}

}  // namespace tet
