#include "server/http/http_port.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <map>
#include <optional>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/wire/loopback.h"
#include "server/http/grpc_place.h"
#include "server/http/http_connection.h"
#include "server/http/http_listener.h"
#include "server/http/http_tls.h"
#include "server/http/listener_watch.h"
#include "server/http/open_api.h"
#include "server/ops/logging.h"
#include "server/ops/sieve.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kTick{250};
constexpr std::chrono::seconds kGoodbye{1};
// Who began a request or an answer and takes longer over a stride of it may have to go, for
// others.
constexpr std::chrono::seconds kStrideTime{1};

/// Counts refusals by their status, each of which has a place of its own.
class RefusalCounts {
 public:
  void count(int status) {
    const auto* found = std::find(kStatuses.begin(), kStatuses.end(), status);
    const auto place = static_cast<std::size_t>(found - kStatuses.begin());
    counts_[std::min(place, kStatuses.size() - 1)].fetch_add(1);
  }
  void add_to(std::vector<Reading>& readings) const {
    for (std::size_t i = 0; i < kStatuses.size(); ++i) {
      const bool last = i + 1 == kStatuses.size();
      readings.push_back(counter(
          "tetstream_http_refusals_total", "requests over HTTP that became no call, by status",
          counts_[i].load(), {{"status", last ? "other" : absl::StrCat(kStatuses[i])}}));
    }
  }

 private:
  /// The last one stands for all others.
  static constexpr std::array kStatuses{400, 403, 404, 405, 408, 413, 415, 421, 431, 503, 0};
  std::array<std::atomic<std::uint64_t>, kStatuses.size()> counts_{};
};

std::shared_ptr<grpc::GenericStub> stub_of(grpc::Server& server) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return std::make_shared<grpc::GenericStub>(server.InProcessChannel(arguments));
}

HttpLimits limits_of(const Config& config) {
  HttpLimits limits;
  limits.head.bytes = static_cast<std::size_t>(config.max_metadata_bytes);
  limits.body_bytes = static_cast<std::size_t>(config.max_request_bytes);
  limits.buffered_bytes = static_cast<std::size_t>(config.receive_bytes / 2);
  limits.stall_time = std::chrono::seconds(config.stall_seconds);
  return limits;
}

}  // namespace

struct HttpPort::Impl {
  using Clock = HttpConnection::Clock;

  Impl(const Config& config, HttpService service, HttpListener at, PageFiles page)
      : listener(std::move(at)),
        most_connections(config.max_http_connections),
        place{loop,
              HttpGate(is_loopback(config.http_listen), config.http_origins),
              std::move(page),
              grpc::Slice(open_api()),
              grpc::Slice(grpc_place_json(service.grpc_address, service.tls != nullptr)),
              stub_of(service.server),
              std::move(service.metrics),
              std::move(service.history),
              std::move(service.ready),
              !config.tokens.empty()},
        keepalive(config.keepalive_seconds),
        shared{place, limits_of(config), [this](int status) { refused(status); },
               [this](int descriptor) { connections.erase(descriptor); },
               [this](const HttpConnection& other) { return close_one_that_fills(other); }} {
    if (service.tls != nullptr) tls.emplace(*service.tls);
  }
  ~Impl();

  Accepted accept_one();
  void admit(AcceptedSocket accepted);
  template <class Since>
  bool close_earliest(const Since& since, Clock::time_point end);
  bool close_one_that_waits();
  bool close_one_that_fills(const HttpConnection& newcomer);
  std::vector<std::shared_ptr<HttpConnection>> all() const;
  void tick();
  void close_all();
  void refused(int status);

  HttpListener listener;
  const std::uint64_t most_connections;
  std::optional<HttpTls> tls;
  EventLoop loop{kTick, [this] { tick(); }};
  ListenerWatch watch{loop, listener.descriptor.number(), [this] { return accept_one(); }};
  HttpPlace place;
  const std::chrono::seconds keepalive;
  HttpShared shared;
  std::map<int, std::shared_ptr<HttpConnection>> connections;  ///< by descriptor
  std::promise<void>* closing = nullptr;  ///< told when all connections are closed
  Clock::time_point last_moment;
  std::atomic<std::uint64_t> open{0}, accepted{0};
  RefusalCounts refusals;
  Sieve sieve;
};

HttpPort::Impl::~Impl() {
  std::promise<void> closed;
  loop.post([&] {
    watch.end();
    closing = &closed;
    last_moment = Clock::now() + kGoodbye;
    close_all();
  });
  closed.get_future().wait();
  loop.stop();
}

/// Closes what has nothing to send, or all of it at the last moment; the ticks go on with it.
void HttpPort::Impl::close_all() {
  const bool last = Clock::now() >= last_moment;
  for (const auto& connection : all()) {
    if (last || !connection->is_sending()) connection->close();
  }
  if (connections.empty()) std::exchange(closing, nullptr)->set_value();
}

Accepted HttpPort::Impl::accept_one() {
  AcceptedSocket next;
  const Accepted taken = accept_http(listener.descriptor, keepalive, next);
  if (taken == Accepted::kOne) admit(std::move(next));
  // Then there is room when the event comes again, which it does at once.
  if (taken == Accepted::kNoRoom && close_one_that_waits()) return Accepted::kNone;
  return taken;
}

void HttpPort::Impl::admit(AcceptedSocket next) {
  accepted.fetch_add(1);
  if (connections.size() >= most_connections && !close_one_that_waits()) return refused(503);
  SslSession session = tls ? tls->begin() : nullptr;
  if (tls && session == nullptr) return refused(503);
  const int number = next.descriptor.number();
  const auto connection = std::make_shared<HttpConnection>(
      shared, HttpSocket(std::move(next.descriptor), std::move(session), std::move(next.peer)));
  connections[number] = connection;
  connection->open();
  open = connections.size();
}

/// Closes the connection with the earliest time, where `since` tells one before `end`.
template <class Since>
bool HttpPort::Impl::close_earliest(const Since& since, Clock::time_point end) {
  std::shared_ptr<HttpConnection> earliest;
  for (const auto& [number, connection] : connections) {
    const std::optional<Clock::time_point> time = since(*connection);
    if (!time || *time >= end) continue;
    earliest = connection;
    end = *time;
  }
  if (earliest != nullptr) earliest->close();
  return earliest != nullptr;
}

/// Closes the connection that has kept us waiting for a request for the longest; where all have
/// sent one, the one that has been in its stride for the longest. False where all are served.
bool HttpPort::Impl::close_one_that_waits() {
  return close_earliest([](const auto& each) { return each.waiting_since(); },
                        Clock::time_point::max()) ||
         close_earliest([](const auto& each) { return each.slow_since(); },
                        Clock::now() - kStrideTime);
}

bool HttpPort::Impl::close_one_that_fills(const HttpConnection& newcomer) {
  const auto since = [&](const HttpConnection& each) {
    return &each != &newcomer && each.has_buffered() ? each.slow_since() : std::nullopt;
  };
  return close_earliest(since, Clock::now() - kStrideTime);
}

/// Returns them in a list of their own, as they leave the map when they close.
std::vector<std::shared_ptr<HttpConnection>> HttpPort::Impl::all() const {
  std::vector<std::shared_ptr<HttpConnection>> all;
  for (const auto& [number, connection] : connections) all.push_back(connection);
  return all;
}

void HttpPort::Impl::tick() {
  const auto now = Clock::now();
  for (const auto& connection : all()) connection->check(now);
  open = connections.size();
  if (closing != nullptr) return close_all();
  watch.look_again();
}

void HttpPort::Impl::refused(int status) {
  refusals.count(status);
  const auto left_out = sieve.pass();
  if (!left_out) return;
  log_event(spdlog::level::warn, "http_refused", {{"status", status}, {"left_out", *left_out}});
}

absl::StatusOr<std::unique_ptr<HttpPort>> HttpPort::open(const Config& config,
                                                         HttpService service) {
  const auto address = parse_listen_address("http_listen", config.http_listen);
  if (!address.ok()) return address.status();
  auto page = PageFiles::open(config.http_page);
  if (!page.ok()) return page.status();
  auto listener = listen_for_http(*address);
  if (!listener.ok()) return listener.status();
  auto impl = std::make_unique<Impl>(config, std::move(service), *std::move(listener),
                                     *std::move(page));
  impl->watch.begin();
  impl->loop.start();
  return std::unique_ptr<HttpPort>(new HttpPort(std::move(impl)));
}

HttpPort::HttpPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

HttpPort::~HttpPort() = default;

const std::string& HttpPort::address() const { return impl_->listener.address; }

std::vector<Reading> HttpPort::readings() const {
  std::vector<Reading> readings{
      gauge("tetstream_http_connections", "connections over HTTP", impl_->open.load()),
      counter("tetstream_http_connections_total", "connections over HTTP that were taken",
              impl_->accepted.load())};
  impl_->refusals.add_to(readings);
  return readings;
}

}  // namespace tet
