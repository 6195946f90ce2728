#include "server/server.h"

#include <atomic>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/resource_quota.h>

#include "core/base/posix/socket_file.h"
#include "proto/wire/transport.h"
#include "server/grids/grid_service.h"
#include "server/http/http_port.h"
#include "server/jobs/store/open_job_store.h"
#include "server/jobs_in_server.h"
#include "server/listening.h"
#include "server/ops/end_connections.h"
#include "server/ops/guard.h"
#include "server/ops/latest_readings.h"
#include "server/ops/logging.h"
#include "server/ops/memory.h"
#include "server/ops/metric_history.h"
#include "server/ops/metrics_port.h"
#include "server/ops/process_metrics.h"
#include "server/reflection.h"
#include "server/rpc/access.h"
#include "server/rpc/handler_watch.h"
#include "server/rpc/health_service.h"
#include "server/rpc/heartbeat.h"
#include "server/rpc/tls.h"
#include "server/rpc/unread_messages.h"
#include "server/server_probes.h"
#include "server/server_readings.h"
#include "server/streams/mesh_service.h"

namespace tet {

namespace {

constexpr int kDiskThreads = 2;
constexpr std::chrono::seconds kGoodbye{1};
constexpr std::chrono::seconds kLastBytes{2};
constexpr std::chrono::hours kForever{24 * 365};
constexpr std::chrono::milliseconds kHeartbeat{100};
constexpr std::chrono::milliseconds kHealthBeat{500};

AdmissionLimits admission_limits(const Config& config) {
  AdmissionLimits limits;
  limits.calls = {config.max_calls, config.max_client_calls};
  limits.uploads = {config.max_uploads, config.max_client_uploads};
  limits.meshes = {config.max_streams, config.max_client_streams};
  limits.queued_meshes = {config.max_queued, config.max_client_queued};
  limits.client_upload_bytes = config.max_client_upload_bytes;
  limits.queue_time = std::chrono::seconds(config.queue_seconds);
  return limits;
}

/// Null where no certificate is given.
absl::StatusOr<std::unique_ptr<ServerTls>> open_tls(const Config& config) {
  if (config.tls_cert.empty() != config.tls_key.empty()) {
    return absl::InvalidArgumentError("tls_cert and tls_key go together");
  }
  if (!config.tls_cert.empty()) {
    return ServerTls::open({config.tls_cert, config.tls_key, config.tls_client_ca});
  }
  if (config.tls_client_ca.empty()) return nullptr;
  return absl::InvalidArgumentError("tls_client_ca needs tls_cert and tls_key");
}

/// Who evicts a grid has to know which ones jobs need: one database knows that of all servers.
StoreSharing sharing_of(const Config& config) {
  return is_postgres(config.jobs) ? StoreSharing::kServers : StoreSharing::kAlone;
}

void set_readiness(HealthService& health, bool ready) {
  health.set("", ready);
  health.set("readiness", ready);
}

}  // namespace

// In the order they are needed; destroyed in the other.
struct Server::Parts {
  Parts(Config server_config,
        std::unique_ptr<Access> who,
        std::unique_ptr<GridStore> grid_store)
      : config(std::move(server_config)),
        access(std::move(who)),
        store(std::move(grid_store)) {}

  absl::Status open_jobs();
  absl::Status open_shared_memory();
  absl::Status listen();
  absl::Status open_metrics();
  absl::Status open_http();
  std::string unix_address() const {
    return config.listen_unix.empty() ? "" : absl::StrCat("unix:", config.listen_unix);
  }
  /// host:port, the port being the one that was really taken; or the socket file's.
  std::string grpc_address() const {
    if (config.listen.empty()) return unix_address();
    return absl::StrCat(config.listen.substr(0, config.listen.rfind(':')), ":", port);
  }
  bool works() const { return !admission.is_ending() && probes.works(); }
  void tell_health();
  std::vector<Reading> slow_readings() const;
  std::string metrics_text(bool for_operators);

  const Config config;
  std::unique_ptr<ServerTls> tls;  ///< null where the port is plain
  std::unique_ptr<Access> access;
  std::unique_ptr<GridStore> store;
  Admission admission{admission_limits(config)};
  CallRegistry calls{*access, admission};
  FairTasks disk_turns{disk, &calls.clients()};
  TaskPool disk{kDiskThreads};  // ends first: a task is charged once it is done
  MeshEngine engine{config, calls, *store};
  GridService grid_service{*store,          calls,         disk_turns,
                           engine.decoders, engine.stalls, config.resident_bytes};
  MeshService mesh_service{engine};
  HealthService health_service{{config.max_health_watches, config.max_client_health_watches}};
  Heartbeat heartbeat{kHeartbeat, [this] {
                        admission.expire(Admission::Clock::now());
                        engine.check_stalls(Stallable::Clock::now());
                        engine.give_up_idle();
                      }};
  ServerProbes probes{config};
  std::unique_ptr<JobsInServer> jobs;  ///< null where they are off
  UnreadMessages unread;
  std::optional<SocketFile> socket_file;            ///< of listen_unix
  std::unique_ptr<SharedMemoryPort> shared_memory;  ///< beside it
  std::unique_ptr<grpc::Server> server;
  LatestReadings latest{[this] { return slow_readings(); }};
  MetricHistory history;
  std::unique_ptr<MetricsPort> metrics;
  std::unique_ptr<HttpPort> http;                   ///< its calls are the server's
  std::atomic<const HttpPort*> open_port{nullptr};  ///< it, once it is open: for its own thread
  std::unique_ptr<Heartbeat> health;                ///< tells whoever asks
  std::unique_ptr<Heartbeat> sampling;              ///< fills the history
  int port = 0;
  bool stopped = false;
};

namespace {

using ChannelArguments = std::map<std::string, int>;

/// What both ends of the wire use, and over it what one client may take of the transport.
ChannelArguments channel_arguments(const Config& config) {
  ChannelArguments arguments;
  for (const TransportSetting& setting : kTransportSettings) {
    arguments[setting.name] = setting.value;
  }
  const auto set = [&](const char* name, std::uint64_t value) {
    arguments[name] = static_cast<int>(value);
  };
  constexpr std::uint64_t kMs = 1000;
  set(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, config.receive_window_bytes);
  set(GRPC_ARG_MAX_CONCURRENT_STREAMS, config.max_connection_streams);
  set(GRPC_ARG_MAX_METADATA_SIZE, config.max_metadata_bytes);
  set(GRPC_ARG_KEEPALIVE_TIME_MS, config.keepalive_seconds * kMs);
  set(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, config.keepalive_seconds * kMs);
  set(GRPC_ARG_MAX_CONNECTION_IDLE_MS, config.connection_idle_seconds * kMs);
  set(GRPC_ARG_MAX_CONNECTION_AGE_MS, config.connection_age_seconds * kMs);
  set(GRPC_ARG_MAX_CONNECTION_AGE_GRACE_MS, config.connection_grace_seconds * kMs);
  set(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, config.handshake_seconds * kMs);
  // Two servers on one port would share its calls by chance.
  set(GRPC_ARG_ALLOW_REUSEPORT, 0);
  return arguments;
}

}  // namespace

absl::Status Server::Parts::open_jobs() {
  auto opened = JobsAtWork::open(config, engine, StoreUse::kOwn);
  if (opened.ok() && *opened != nullptr) {
    jobs = std::make_unique<JobsInServer>(std::move(*opened), engine, *store);
    engine.results = jobs->work->results.get();
    store->ask_before_evicting([this] { return grids_of_jobs(*jobs->work->store); });
  }
  return opened.status();
}

absl::Status Server::Parts::open_shared_memory() {
  if (config.shared_memory != "on") return absl::OkStatus();
  auto opened = SharedMemoryPort::open(config.listen_unix, socket_rights(config));
  if (!opened.ok()) return opened.status();
  shared_memory = *std::move(opened);
  engine.shared_memory = shared_memory.get();
  return absl::OkStatus();
}

absl::Status Server::Parts::listen() {
  if (!config.listen_unix.empty()) {
    auto prepared = SocketFile::prepare(config.listen_unix);
    if (!prepared.ok()) return prepared.status();
    socket_file.emplace(*std::move(prepared));
    if (absl::Status status = open_shared_memory(); !status.ok()) return status;
  }
  grpc::ServerBuilder builder;
  for (const auto& [name, value] : channel_arguments(config)) {
    builder.AddChannelArgument(name, value);
  }
  builder.SetMaxReceiveMessageSize(static_cast<int>(config.max_request_bytes));
  refuse_compression(builder);
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> watches;
  std::set<std::string> services{v1::GridService::service_full_name(),
                                 v1::MeshService::service_full_name()};
  if (jobs != nullptr) services.insert(v1::JobService::service_full_name());
  watches.push_back(watch_handlers(std::move(services)));
  watches.push_back(watch_messages(unread));
  builder.experimental().SetInterceptorCreators(std::move(watches));
  grpc::ResourceQuota quota("tetstreamd");
  quota.Resize(config.receive_bytes);
  builder.SetResourceQuota(quota);
  if (!config.listen.empty()) {
    builder.AddListeningPort(
        config.listen, tls ? tls->credentials() : grpc::InsecureServerCredentials(), &port);
  }
  if (socket_file) {
    builder.AddListeningPort(absl::StrCat("unix:", socket_file->bind_path()),
                             grpc::InsecureServerCredentials());
  }
  choose_reflection(builder, config);
  builder.RegisterService(&grid_service);
  builder.RegisterService(&mesh_service);
  builder.RegisterService(&health_service);
  if (jobs != nullptr) builder.RegisterService(&jobs->service);
  server = builder.BuildAndStart();
  if (server == nullptr || (port == 0 && !config.listen.empty())) {
    return absl::UnavailableError(absl::StrCat(
        "cannot listen on ", config.listen.empty() ? unix_address() : config.listen));
  }
  return socket_file ? socket_file->publish(socket_rights(config)) : absl::OkStatus();
}

absl::Status Server::Parts::open_metrics() {
  if (config.metrics_listen.empty()) return absl::OkStatus();
  auto opened = MetricsPort::open(config.metrics_listen, {[this] { return metrics_text(true); },
                                                          [this] { return works(); }});
  if (opened.ok()) metrics = std::move(*opened);
  return opened.status();
}

absl::Status Server::Parts::open_http() {
  if (config.http_listen.empty()) return absl::OkStatus();
  const auto tell = [this](absl::string_view families) {
    return history.tell(MetricHistory::Clock::now(), families);
  };
  auto opened =
      HttpPort::open(config, {*server, tls.get(), [this] { return metrics_text(false); }, tell,
                              [this] { return works(); }, grpc_address()});
  if (!opened.ok()) return opened.status();
  http = *std::move(opened);
  open_port = http.get();
  const auto sample = [this] {
    history.take(MetricHistory::Clock::now(), metrics_text(false));
  };
  sample();
  sampling = std::make_unique<Heartbeat>(MetricHistory::kInterval, sample);
  return absl::OkStatus();
}

void Server::Parts::tell_health() {
  const auto tell = [this] {
    set_readiness(health_service, works());
    if (jobs != nullptr) health_service.set("jobs", jobs->health.status().ok());
  };
  tell();
  health = std::make_unique<Heartbeat>(kHealthBeat, tell);
}

/// What asks a disk or a database, or waits for who does.
std::vector<Reading> Server::Parts::slow_readings() const {
  store->catch_up();
  std::vector<Reading> readings = read_server(engine, *store);
  for (Reading& reading : read_credentials(*access, tls.get())) {
    readings.push_back(std::move(reading));
  }
  if (jobs != nullptr) {
    for (Reading& reading : jobs->work->readings()) readings.push_back(std::move(reading));
  }
  return readings;
}

/// Any token may read them over HTTP: who the others are, and what they use, is not for them.
std::string Server::Parts::metrics_text(bool for_operators) {
  return calls.metrics().text([this, for_operators] {
    std::vector<Reading> readings = latest.get();
    const auto add = [&](std::vector<Reading> more) {
      for (Reading& reading : more) readings.push_back(std::move(reading));
    };
    if (for_operators) add(calls.clients().readings());
    add(probes.readings());
    if (jobs != nullptr) add({jobs->up()});
    add(unread.readings());
    add(health_service.readings());
    if (const HttpPort* const port_now = open_port.load()) add(port_now->readings());
    add(read_process());
    return readings;
  });
}

absl::StatusOr<std::unique_ptr<Server>> Server::start(const Config& settings) {
  static const bool registered = [] {
    log_contained_exceptions();
    prepare_reflection();
    return true;
  }();
  static_cast<void>(registered);
  Config config = settings;
  if (auto divided = divide_memory(config); !divided.ok()) return divided;
  if (auto listens = check_listening(config); !listens.ok()) return listens;
  auto tls = open_tls(config);
  if (!tls.ok()) return tls.status();
  auto access = Access::open(config.tokens);
  if (!access.ok()) return access.status();
  auto store = GridStore::open(config.store, config.store_bytes, config.disk_reserve_bytes,
                               sharing_of(config));
  if (!store.ok()) return store.status();
  auto parts = std::make_unique<Parts>(config, *std::move(access), *std::move(store));
  parts->tls = *std::move(tls);
  if (const absl::Status opened = parts->open_jobs(); !opened.ok()) return opened;
  parts->health_service.set("liveness", true);
  if (const absl::Status opened = parts->listen(); !opened.ok()) return opened;
  if (const absl::Status opened = parts->open_http(); !opened.ok()) return opened;
  if (const absl::Status opened = parts->open_metrics(); !opened.ok()) return opened;
  parts->tell_health();
  warn_if_exposed(config);
  return std::unique_ptr<Server>(new Server(std::move(parts)));
}

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Server::~Server() { stop(std::chrono::seconds(0)); }

std::string Server::address() const { return parts_->grpc_address(); }

int Server::port() const { return parts_->port; }

std::string Server::unix_address() const { return parts_->unix_address(); }

std::string Server::metrics_address() const {
  return parts_->metrics == nullptr ? "" : parts_->metrics->address();
}

std::string Server::http_address() const {
  return parts_->http == nullptr ? "" : parts_->http->address();
}

const MeshEngine& Server::engine() const { return parts_->engine; }

int Server::running_calls() const { return parts_->calls.running(); }

void Server::announce_end() {
  parts_->admission.announce_end();
  parts_->health.reset();
  set_readiness(parts_->health_service, false);
}

// While it drains the server goes on answering health checks, so that whoever balances the load
// sees NOT_SERVING; gRPC's own shutdown would close their connections first.
void Server::stop(std::chrono::seconds drain) {
  if (std::exchange(parts_->stopped, true)) return;
  parts_->admission.drain();
  parts_->health.reset();
  set_readiness(parts_->health_service, false);
  if (parts_->jobs != nullptr) parts_->jobs->work->worker.stop();
  const bool idle = parts_->calls.wait_until_idle(CallRegistry::Clock::now() + drain);
  if (!idle) {
    log_event(spdlog::level::warn, "cancelling", {{"calls", parts_->calls.running()}});
    parts_->calls.cut();
    parts_->calls.wait_until_idle(CallRegistry::Clock::now() + kGoodbye);
  }
  parts_->metrics.reset();  // which reads the port that goes
  parts_->sampling.reset();
  parts_->open_port = nullptr;
  parts_->http.reset();
  parts_->health_service.end();
  const auto grace = idle ? kGoodbye : std::chrono::seconds(0);
  // gRPC would wait for the peer of each connection that it writes to just now.
  const Heartbeat ending(kLastBytes, [this] {
    end_connections(parts_->port,
                    parts_->socket_file ? parts_->socket_file->bind_path() : std::string());
  });
  parts_->server->Shutdown(std::chrono::system_clock::now() + grace);
  // gRPC is done; the last tasks of cancelled calls may not be.
  parts_->calls.wait_until_idle(CallRegistry::Clock::now() + kForever);
}

}  // namespace tet
