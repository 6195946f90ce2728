#include "server/rpc/health_service.h"

#include <optional>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/rpc/access.h"

namespace tet {

namespace {

/// Names of services that anybody has are shorter.
constexpr std::size_t kMaxServiceBytes = 256;

absl::Status check_name(const std::string& service) {
  if (service.size() <= kMaxServiceBytes) return absl::OkStatus();
  return invalid_field(absl::StrCat("service has ", service.size(), " bytes; at most ",
                                    kMaxServiceBytes, " are looked at"));
}

}  // namespace

/// One Watch call: a message at a time, and only the latest news. Whoever takes none keeps
/// nothing but the call.
class HealthService::Watcher final : public grpc::ServerWriteReactor<Response>,
                                     public std::enable_shared_from_this<Watcher> {
 public:
  Watcher(HealthService& health, std::string service)
      : health_(health), service_(std::move(service)) {}

  /// To be called once; it lives until gRPC is done with it.
  void begin(const absl::Status& admitted) {
    self_ = shared_from_this();
    admitted.ok() ? advance() : end(admitted);
  }

  /// Writes what is new, unless something is being written: then that is followed by it.
  void advance() {
    const std::shared_ptr<Watcher> here = shared_from_this();  // gRPC may be done meanwhile
    switch (next_step()) {
      case Step::kWait:
        return;
      case Step::kWrite:
        return StartWrite(&response_);
      case Step::kFinish:
        return Finish(to_grpc(*end_));
    }
  }

  /// Only the first end counts.
  void end(const absl::Status& status) {
    {
      const std::lock_guard lock(mutex_);
      if (!end_) end_ = status;
    }
    advance();
  }

 private:
  enum class Step { kWait, kWrite, kFinish };

  Step next_step() {
    const std::lock_guard lock(mutex_);
    if (writing_ || finished_) return Step::kWait;
    if (end_) {
      finished_ = true;
      return Step::kFinish;
    }
    const Response::ServingStatus now = health_.status_of(service_);
    if (told_ == now) return Step::kWait;
    told_ = now;
    response_.set_status(now);
    writing_ = true;
    return Step::kWrite;
  }

  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
    }
    ok ? advance() : end(absl::CancelledError("the client has gone"));
  }
  void OnCancel() override { end(absl::CancelledError("the client has gone")); }
  void OnDone() override {
    health_.forget(*this);
    const std::shared_ptr<Watcher> last = std::move(self_);
  }

  HealthService& health_;
  const std::string service_;
  std::shared_ptr<Watcher> self_;
  std::mutex mutex_;  ///< guards all below
  Response response_;
  std::optional<Response::ServingStatus> told_;
  std::optional<absl::Status> end_;  ///< how the call ends; set once
  bool writing_ = false, finished_ = false;
};

void HealthService::set(const std::string& service, bool serving) {
  std::vector<std::shared_ptr<Watcher>> watchers;
  {
    const std::lock_guard lock(mutex_);
    const auto [place, is_new] = services_.try_emplace(service, serving);
    if (!is_new && place->second == serving) return;
    place->second = serving;
    for (const auto& [key, watched] : watchers_) watchers.push_back(watched.watcher.lock());
  }
  for (const auto& watcher : watchers) {
    if (watcher != nullptr) watcher->advance();
  }
}

void HealthService::end() {
  std::vector<std::shared_ptr<Watcher>> watchers;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    for (const auto& [key, watched] : watchers_) watchers.push_back(watched.watcher.lock());
  }
  for (const auto& watcher : watchers) {
    if (watcher != nullptr) watcher->end(shutting_down());
  }
}

std::vector<Reading> HealthService::readings() const {
  const std::lock_guard lock(mutex_);
  return {
      gauge("tetstream_health_watches", "Watch calls of the health service under way.",
            watches_.all()),
      counter("tetstream_health_checks_total", "Checks of the health service.", checks_.load()),
      counter("tetstream_health_watches_refused_total",
              "Watch calls of the health service beyond the limits.", refused_.load())};
}

grpc::ServerUnaryReactor* HealthService::Check(grpc::CallbackServerContext* context,
                                               const Request* request,
                                               Response* response) {
  checks_.fetch_add(1);
  absl::Status status = check_name(request->service());
  if (status.ok()) {
    response->set_status(status_of(request->service()));
    if (response->status() == Response::SERVICE_UNKNOWN) {
      status = absl::NotFoundError(
          absl::StrCat("there is no service ", request->service(), " here"));
    }
  }
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  reactor->Finish(to_grpc(status));
  return reactor;
}

/// A watch of an unknown service says so, and goes on: it may come.
grpc::ServerWriteReactor<HealthService::Response>* HealthService::Watch(
    grpc::CallbackServerContext* context, const Request* request) {
  absl::Status status = check_name(request->service());
  const auto watcher =
      std::make_shared<Watcher>(*this, status.ok() ? request->service() : std::string());
  if (status.ok()) status = admit(watcher, name_of_peer(*context));
  watcher->begin(status);
  return watcher.get();
}

HealthService::Response::ServingStatus HealthService::status_of(
    const std::string& service) const {
  const std::lock_guard lock(mutex_);
  const auto found = services_.find(service);
  if (found == services_.end()) return Response::SERVICE_UNKNOWN;
  return found->second ? Response::SERVING : Response::NOT_SERVING;
}

absl::Status HealthService::admit(const std::shared_ptr<Watcher>& watcher,
                                  const std::string& client) {
  const std::lock_guard lock(mutex_);
  absl::Status status = ended_ ? shutting_down() : watches_.check(client);
  if (!status.ok()) {
    refused_.fetch_add(1);
    return status;
  }
  watches_.add(client);
  watchers_[watcher.get()] = {watcher, client};
  return status;
}

void HealthService::forget(const Watcher& watcher) {
  const std::lock_guard lock(mutex_);
  const auto found = watchers_.find(&watcher);
  if (found == watchers_.end()) return;  // it was refused
  watches_.remove(found->second.client);
  watchers_.erase(found);
}

}  // namespace tet
