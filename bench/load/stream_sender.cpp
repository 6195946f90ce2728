#include "bench/load/stream_sender.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <list>
#include <mutex>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include "bench/load/stream_check.h"
#include "client/channel.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::load {
namespace {

namespace v1 = ::tetstream::v1;

class StreamSender;

/// One call; deletes itself when it is over.
class StreamCall final : public grpc::ClientReadReactor<v1::MeshEvent> {
 public:
  StreamCall(StreamSender& sender, const LoadRequest& request, RequestSender::Done done);

  void start(v1::MeshService::Stub& stub);
  void cancel() { context_.TryCancel(); }

  std::list<StreamCall*>::iterator place;  ///< among its sender's calls

 private:
  void OnReadDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  StreamSender& sender_;
  RequestSender::Done done_;
  grpc::ClientContext context_;
  v1::StreamMeshRequest message_;
  v1::MeshEvent event_;
  StreamCheck check_;
  Outcome outcome_;
};

class StreamSender final : public RequestSender {
 public:
  explicit StreamSender(const StreamSettings& settings)
      : check_columns_(settings.check_columns) {
    for (int i = 0; i < settings.connections; ++i) {
      channels_.push_back(open_channel(settings.address));
      stubs_.push_back(v1::MeshService::NewStub(channels_.back()));
    }
  }

  ~StreamSender() override {
    give_up();
    std::unique_lock lock(mutex_);
    all_ended_.wait(lock, [this] { return running_ == 0; });
  }

  absl::Status connect(const StreamSettings& settings) {
    const auto end = std::chrono::system_clock::now() + settings.patience;
    // All at once, not one after the other.
    for (const auto& channel : channels_) channel->GetState(true);
    for (const auto& channel : channels_) {
      if (!channel->WaitForConnected(end)) {
        return absl::UnavailableError(absl::StrCat("no connection to ", settings.address));
      }
    }
    return absl::OkStatus();
  }

  void send(const LoadRequest& request, Done done) override {
    auto* call = new StreamCall(*this, request, std::move(done));
    v1::MeshService::Stub* stub = nullptr;
    {
      const std::lock_guard lock(mutex_);
      call->place = calls_.insert(calls_.end(), call);
      ++running_;
      stub = stubs_[next_stub_++ % stubs_.size()].get();
    }
    call->start(*stub);
  }

  void give_up() override {
    const std::lock_guard lock(mutex_);
    for (StreamCall* call : calls_) call->cancel();
  }

  Traffic traffic() const override { return {tets_, bytes_}; }

  void count(std::uint64_t tets, std::uint64_t bytes) {
    tets_.fetch_add(tets, std::memory_order_relaxed);
    bytes_.fetch_add(bytes, std::memory_order_relaxed);
  }

  /// From here on nobody cancels it.
  void forget(const StreamCall& call) {
    const std::lock_guard lock(mutex_);
    calls_.erase(call.place);
  }

  /// A call is gone: the last thing that it does to its sender.
  void ended() {
    const std::lock_guard lock(mutex_);
    if (--running_ == 0) all_ended_.notify_all();
  }

  bool check_columns() const { return check_columns_; }

 private:
  const bool check_columns_;
  std::vector<std::shared_ptr<grpc::Channel>> channels_;
  std::vector<std::unique_ptr<v1::MeshService::Stub>> stubs_;
  std::atomic<std::uint64_t> tets_{0}, bytes_{0};
  std::mutex mutex_;
  std::condition_variable all_ended_;
  std::list<StreamCall*> calls_;
  std::size_t running_ = 0, next_stub_ = 0;
};

StreamCall::StreamCall(StreamSender& sender,
                       const LoadRequest& request,
                       RequestSender::Done done)
    : sender_(sender), done_(std::move(done)), check_(sender.check_columns()) {
  *message_.mutable_mesh() = request.message;
  if (request.give_up) {
    const auto left = *request.give_up - Clock::now();
    context_.set_deadline(std::chrono::system_clock::now() +
                          std::chrono::duration_cast<std::chrono::microseconds>(left));
  }
}

void StreamCall::start(v1::MeshService::Stub& stub) {
  outcome_.sent = Clock::now();
  stub.async()->StreamMesh(&context_, &message_, this);
  StartRead(&event_);
  StartCall();
}

void StreamCall::OnReadDone(bool ok) {
  if (!ok) return;  // OnDone tells why
  const TimePoint now = Clock::now();
  if (event_.has_header() && !outcome_.header) outcome_.header = now;
  if (event_.has_chunk()) {
    const v1::MeshChunk& chunk = event_.chunk();
    const std::uint64_t tets =
        static_cast<std::uint64_t>(std::max<std::int64_t>(chunk.tet_count(), 0));
    const std::uint64_t bytes =
        chunk.positions().size() + chunk.tets().size() + chunk.regions().size();
    if (!outcome_.first_chunk) outcome_.first_chunk = now;
    outcome_.tets += tets;
    outcome_.bytes += bytes;
    sender_.count(tets, bytes);
  }
  outcome_.status = check_.take(event_);
  if (!outcome_.status.ok()) return cancel();
  StartRead(&event_);
}

void StreamCall::OnDone(const grpc::Status& status) {
  outcome_.ended = Clock::now();
  if (outcome_.status.ok() && !status.ok()) {
    outcome_.status = absl::Status(static_cast<absl::StatusCode>(status.error_code()),
                                   status.error_message());
  }
  if (outcome_.status.ok()) outcome_.status = check_.ended();
  StreamSender& sender = sender_;
  sender.forget(*this);
  const RequestSender::Done done = std::move(done_);
  const Outcome outcome = std::move(outcome_);
  delete this;
  done(outcome);
  sender.ended();
}

}  // namespace

absl::StatusOr<std::unique_ptr<RequestSender>> open_stream_sender(
    const StreamSettings& settings) {
  auto sender = std::make_unique<StreamSender>(settings);
  if (absl::Status status = sender->connect(settings); !status.ok()) return status;
  return sender;
}

}  // namespace tet::load
