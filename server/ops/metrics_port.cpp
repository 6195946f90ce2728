#include "server/ops/metrics_port.h"

#include <httplib.h>
#include <semaphore>
#include <sys/socket.h>
#include <thread>
#include <utility>

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

namespace tet {

namespace {

constexpr int kThreads = 2;
constexpr int kConnections = 16;
constexpr std::size_t kMaxBody = 1024;
constexpr std::chrono::seconds kPatience{2};

/// The library's own queue grows with every connection; this one makes the next one wait.
class BoundedQueue final : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> serve) override {
    room_.acquire();
    pool_.enqueue([this, serve = std::move(serve)] {
      serve();
      room_.release();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::counting_semaphore<kConnections> room_{kConnections};
  httplib::ThreadPool pool_{kThreads};
};

struct Address {
  std::string host;
  int port = 0;
};

absl::StatusOr<Address> parse_address(const std::string& listen) {
  const std::size_t colon = listen.rfind(':');
  Address address;
  if (colon != std::string::npos && colon > 0 &&
      absl::SimpleAtoi(listen.substr(colon + 1), &address.port) && address.port >= 0 &&
      address.port <= 65'535) {
    address.host = listen.substr(0, colon);
    return address;
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("metrics_listen \"%s\" is not host:port", listen));
}

/// Removes brackets, which only the text of an address with a port needs.
std::string bare(const std::string& host) {
  return host.size() > 2 && host.front() == '[' ? host.substr(1, host.size() - 2) : host;
}

// The library would let two servers share one port by chance.
void reuse_address(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

void answer_yes_or_no(httplib::Response& response, bool yes) {
  response.status = yes ? 200 : 503;
  response.set_content(yes ? "ok\n" : "not ready\n", "text/plain");
}

}  // namespace

struct MetricsPort::Impl {
  explicit Impl(MetricsPages what) : pages(std::move(what)) {
    server.new_task_queue = [] { return new BoundedQueue; };
    server.set_socket_options(reuse_address);
    server.set_keep_alive_max_count(1);
    server.set_keep_alive_timeout(kPatience.count());
    server.set_read_timeout(kPatience);
    server.set_write_timeout(kPatience);
    server.set_payload_max_length(kMaxBody);
    server.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(pages.metrics(), "text/plain; version=0.0.4; charset=utf-8");
    });
    server.Get("/healthz", [](const httplib::Request&, httplib::Response& response) {
      answer_yes_or_no(response, true);
    });
    server.Get("/readyz", [this](const httplib::Request&, httplib::Response& response) {
      answer_yes_or_no(response, pages.ready());
    });
  }
  ~Impl() {
    server.stop();
    if (thread.joinable()) thread.join();
  }

  bool bind(const Address& asked) {
    const std::string host = bare(asked.host);
    const int port = asked.port == 0                         ? server.bind_to_any_port(host)
                     : server.bind_to_port(host, asked.port) ? asked.port
                                                             : -1;
    address = absl::StrCat(asked.host, ":", port);
    return port > 0;
  }

  const MetricsPages pages;
  httplib::Server server;
  std::string address;
  std::thread thread;
};

absl::StatusOr<std::unique_ptr<MetricsPort>> MetricsPort::open(const std::string& listen,
                                                               MetricsPages pages) {
  const auto address = parse_address(listen);
  if (!address.ok()) return address.status();
  auto impl = std::make_unique<Impl>(std::move(pages));
  if (!impl->bind(*address)) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", listen, " for metrics"));
  }
  impl->thread = std::thread([server = &impl->server] { server->listen_after_bind(); });
  while (!impl->server.is_running()) std::this_thread::yield();  // `stop` before that is lost
  return std::unique_ptr<MetricsPort>(new MetricsPort(std::move(impl)));
}

MetricsPort::MetricsPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

MetricsPort::~MetricsPort() = default;

const std::string& MetricsPort::address() const { return impl_->address; }

}  // namespace tet
