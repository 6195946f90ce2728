#include "server/rpc/client_use.h"

#include "core/base/printable.h"
#include "server/rpc/background.h"

namespace tet {

namespace {

/// A subject may be long, and hold anything.
constexpr std::size_t kMostLabel = 128;

void add_counts(const std::string& client,
                const ClientCounts& counts,
                std::vector<Reading>& readings) {
  const auto add = [&](const char* name, const char* help, auto value) {
    readings.push_back(counter(name, help, value, {{"client", client}}));
  };
  add("tetstream_client_calls_total", "Calls that ended, by client.", counts.calls.load());
  add("tetstream_client_refusals_total", "Calls that failed, by client.",
      counts.refusals.load());
  add("tetstream_client_work_seconds_total", "Time that threads worked for a client.",
      std::chrono::duration<double>(std::chrono::nanoseconds(counts.work_ns.load())).count());
  add("tetstream_client_sent_bytes_total", "Bytes of meshes and samples sent to a client.",
      counts.sent_bytes.load());
  add("tetstream_client_received_bytes_total", "Bytes of grid files received from a client.",
      counts.received_bytes.load());
}

}  // namespace

// By what is told of them: two that are told alike would be one series twice.
ClientCounts& ClientUse::name(const std::string& client) {
  const std::string label = printable(client, kMostLabel);
  const std::lock_guard lock(mutex_);
  const auto found = named_.find(label);
  if (found != named_.end()) return *found->second;
  if (named_.size() >= kMostNames) return others_;
  return *named_.emplace(label, std::make_unique<ClientCounts>()).first->second;
}

ClientCounts& ClientUse::of(const std::string& client) {
  if (is_background(client)) return name(client);
  const std::lock_guard lock(mutex_);
  const auto found = named_.find(printable(client, kMostLabel));
  return found == named_.end() ? others_ : *found->second;
}

std::vector<Reading> ClientUse::readings() const {
  const std::lock_guard lock(mutex_);
  std::vector<Reading> readings;
  for (const auto& [client, counts] : named_) {
    add_counts(client, *counts, readings);
  }
  add_counts(kOthers, others_, readings);
  return readings;
}

}  // namespace tet
