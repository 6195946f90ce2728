#include "bench/load/stream_sender.h"

#include <atomic>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "bench/load/call_book.h"
#include "bench/load/load_call.h"

namespace tet::load {
namespace {

class StreamSender final : public RequestSender {
 public:
  explicit StreamSender(const StreamSettings& settings) : settings_(settings) {}

  absl::Status connect() {
    for (int i = 0; i < settings_.connections; ++i) {
      auto channel = open_channel(settings_.address, settings_.channel);
      if (!channel.ok()) return channel.status();
      servers_.push_back(std::make_unique<LoadServer>(*std::move(channel)));
    }
    const auto end = std::chrono::system_clock::now() + settings_.patience;
    // All at once, not one after the other.
    for (const auto& server : servers_) server->channel.channel()->GetState(true);
    for (const auto& server : servers_) {
      if (!server->channel.channel()->WaitForConnected(end)) {
        return absl::UnavailableError(absl::StrCat("no connection to ", settings_.address));
      }
    }
    return absl::OkStatus();
  }

  void send(const LoadRequest& request, Done done) override {
    LoadServer& server = *servers_[turn_.fetch_add(1) % servers_.size()];
    begin_call(server, book_, {settings_.encoding, settings_.check_columns}, request,
               std::move(done));
  }

  void give_up() override { book_.give_up(); }

  Traffic traffic() const override { return book_.traffic(); }

 private:
  const StreamSettings settings_;
  std::vector<std::unique_ptr<LoadServer>> servers_;
  std::atomic<std::size_t> turn_{0};
  CallBook book_;  // last: its calls use the others
};

}  // namespace

absl::StatusOr<std::unique_ptr<RequestSender>> open_stream_sender(
    const StreamSettings& settings) {
  auto sender = std::make_unique<StreamSender>(settings);
  if (absl::Status status = sender->connect(); !status.ok()) return status;
  return sender;
}

}  // namespace tet::load
