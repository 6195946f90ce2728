#include "server/ops/metrics_port.h"

#include <httplib.h>
#include <semaphore>
#include <sys/socket.h>
#include <thread>
#include <utility>

#include <absl/strings/str_cat.h>

#include "server/ops/end_connections.h"
#include "server/ops/listen_address.h"

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
  // The library would wait for each connection that says nothing, and for those behind it.
  ~Impl() {
    server.stop();
    end_connections(port);
    if (thread.joinable()) thread.join();
  }

  bool bind(const ListenAddress& asked) {
    const std::string host = asked.bare_host();
    port = asked.port == 0                         ? server.bind_to_any_port(host)
           : server.bind_to_port(host, asked.port) ? asked.port
                                                   : -1;
    address = absl::StrCat(asked.host, ":", port);
    return port > 0;
  }

  const MetricsPages pages;
  httplib::Server server;
  std::string address;
  int port = 0;
  std::thread thread;
};

absl::StatusOr<std::unique_ptr<MetricsPort>> MetricsPort::open(const std::string& listen,
                                                               MetricsPages pages) {
  const auto address = parse_listen_address("metrics_listen", listen);
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
