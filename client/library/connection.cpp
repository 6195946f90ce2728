#include "client/library/connection.h"

#include <utility>

#include <absl/strings/str_split.h>

namespace tet {

absl::StatusOr<std::shared_ptr<Connection>> Connection::open(const std::string& address,
                                                             const ChannelOptions& options,
                                                             RetryPolicy retry) {
  std::vector<ServerChannel> servers;
  for (const auto one : absl::StrSplit(address, ',')) {
    auto channel = open_channel(std::string(one), options);
    if (!channel.ok()) return channel.status();
    servers.push_back(*std::move(channel));
  }
  return std::shared_ptr<Connection>(new Connection(std::move(servers), retry));
}

absl::Status Connection::again(Retries& retries,
                               const ServerChannel& failed,
                               const absl::Status& status,
                               std::uint64_t progress) {
  const bool elsewhere = servers_.size() > 1 && absl::IsUnavailable(status);
  // When several calls failed at one server, only the first of them turns to the next.
  if (std::size_t now = turn_.load();
      elsewhere && &servers_[now % servers_.size()] == &failed) {
    turn_.compare_exchange_strong(now, now + 1);
  }
  return retries.again(status, progress, server(), {elsewhere, known_.load()});
}

}  // namespace tet
