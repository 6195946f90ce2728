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
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/client_callback.h>

#include "bench/load/stream_check.h"
#include "client/channel.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::load {
namespace {

namespace v1 = ::tetstream::v1;

class StreamSender;

/// One call; deletes itself when it is over. Messages stay the bytes they came in: parsing them
/// would copy every column.
class StreamCall final : public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  StreamCall(StreamSender& sender, const LoadRequest& request, RequestSender::Done done);

  void start(grpc::GenericStub& stub);
  void cancel() { context_.TryCancel(); }
  grpc::ClientContext& context() { return context_; }

  std::list<StreamCall*>::iterator place;  ///< among its sender's calls

 private:
  void OnReadDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  StreamSender& sender_;
  RequestSender::Done done_;
  grpc::ClientContext context_;
  grpc::ByteBuffer message_, event_;
  StreamCheck check_;
  Outcome outcome_;
};

class StreamSender final : public RequestSender {
 public:
  explicit StreamSender(const StreamSettings& settings) : settings_(settings) {}

  ~StreamSender() override {
    give_up();
    std::unique_lock lock(mutex_);
    all_ended_.wait(lock, [this] { return running_ == 0; });
  }

  absl::Status connect() {
    for (int i = 0; i < settings_.connections; ++i) {
      auto channel = open_channel(settings_.address, settings_.channel);
      if (!channel.ok()) return channel.status();
      channels_.push_back(*std::move(channel));
      stubs_.push_back(std::make_unique<grpc::GenericStub>(channels_.back().channel()));
    }
    const auto end = std::chrono::system_clock::now() + settings_.patience;
    // All at once, not one after the other.
    for (const auto& channel : channels_) channel.channel()->GetState(true);
    for (const auto& channel : channels_) {
      if (!channel.channel()->WaitForConnected(end)) {
        return absl::UnavailableError(absl::StrCat("no connection to ", settings_.address));
      }
    }
    return absl::OkStatus();
  }

  void send(const LoadRequest& request, Done done) override {
    auto* call = new StreamCall(*this, request, std::move(done));
    grpc::GenericStub* stub = nullptr;
    {
      const std::lock_guard lock(mutex_);
      call->place = calls_.insert(calls_.end(), call);
      ++running_;
      const std::size_t turn = next_stub_++ % stubs_.size();
      stub = stubs_[turn].get();
      channels_[turn].authorize(call->context());
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

  const StreamSettings& settings() const { return settings_; }

 private:
  const StreamSettings settings_;
  std::vector<ServerChannel> channels_;
  std::vector<std::unique_ptr<grpc::GenericStub>> stubs_;
  std::atomic<std::uint64_t> tets_{0}, bytes_{0};
  std::mutex mutex_;
  std::condition_variable all_ended_;
  std::list<StreamCall*> calls_;
  std::size_t running_ = 0, next_stub_ = 0;
};

StreamCall::StreamCall(StreamSender& sender,
                       const LoadRequest& request,
                       RequestSender::Done done)
    : sender_(sender), done_(std::move(done)), check_(sender.settings().check_columns) {
  v1::StreamMeshRequest message;
  *message.mutable_mesh() = request.message;
  message.set_encoding(sender.settings().compact ? v1::ENCODING_COMPACT : v1::ENCODING_PLAIN);
  message_ = serialized(message);
  if (request.give_up) {
    const auto left = *request.give_up - Clock::now();
    context_.set_deadline(std::chrono::system_clock::now() +
                          std::chrono::duration_cast<std::chrono::microseconds>(left));
  }
}

void StreamCall::start(grpc::GenericStub& stub) {
  outcome_.sent = Clock::now();
  context_.set_initial_metadata_corked(true);  // sent with the request
  const std::string method =
      absl::StrCat("/", v1::MeshService::service_full_name(), "/StreamMesh");
  stub.PrepareBidiStreamingCall(&context_, method, {}, this);
  StartWriteLast(&message_, grpc::WriteOptions());
  StartRead(&event_);
  StartCall();
}

void StreamCall::OnReadDone(bool ok) {
  if (!ok) return;  // OnDone tells why
  const TimePoint now = Clock::now();
  const std::uint64_t tets = check_.tets(), bytes = check_.column_bytes();
  outcome_.status = check_.take(event_);
  if (check_.has_header() && !outcome_.header) outcome_.header = now;
  if (check_.chunks() > 0 && !outcome_.first_chunk) outcome_.first_chunk = now;
  sender_.count(check_.tets() - tets, check_.column_bytes() - bytes);
  if (!outcome_.status.ok()) return cancel();
  StartRead(&event_);
}

void StreamCall::OnDone(const grpc::Status& status) {
  outcome_.ended = Clock::now();
  outcome_.tets = check_.tets();
  outcome_.bytes = check_.column_bytes();
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
  if (absl::Status status = sender->connect(); !status.ok()) return status;
  return sender;
}

}  // namespace tet::load
