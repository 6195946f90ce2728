#include "bench/load/load_call.h"

#include <chrono>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/client_callback.h>

#include "bench/load/stream_check.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::load {
namespace {

namespace v1 = ::tetstream::v1;

absl::Status to_absl(const grpc::Status& status) {
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

absl::Status error_of(const v1::Job& job) {
  return {static_cast<absl::StatusCode>(job.error().code()), job.error().message()};
}

/// What a job does before its result is read.
struct JobCalls {
  grpc::ClientContext create_context, wait_context;
  v1::CreateJobRequest create;
  v1::WaitJobRequest wait;
  v1::Job job;
};

/// Deletes itself when it is over. Messages of the stream stay the bytes they came in: parsing
/// them would copy every column.
class LoadCall final : public BookedCall,
                       private grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  LoadCall(LoadServer& server,
           CallBook& book,
           const CallSettings& settings,
           const LoadRequest& request,
           RequestSender::Done done)
      : server_(server), book_(book), done_(std::move(done)), check_(settings.check_columns) {
    prepare(context_, request);
    request.kind == RequestKind::kJob ? prepare_job(request)
                                      : prepare_stream(settings, request);
  }

  void start() {
    outcome_.sent = Clock::now();
    job_ ? create_job() : read("/StreamMesh", v1::MeshService::service_full_name());
  }

  /// A context that is cancelled before its call begins cancels it then.
  void cancel() override {
    context_.TryCancel();
    if (!job_) return;
    job_->create_context.TryCancel();
    job_->wait_context.TryCancel();
  }

 private:
  void prepare(grpc::ClientContext& context, const LoadRequest& request) const {
    server_.channel.authorize(context);
    if (!request.give_up) return;
    const auto left = *request.give_up - Clock::now();
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::duration_cast<std::chrono::microseconds>(left));
  }

  void prepare_stream(const CallSettings& settings, const LoadRequest& request) {
    v1::StreamMeshRequest message;
    *message.mutable_mesh() = request.message;
    message.set_encoding(settings.encoding);
    message.set_skip_cache(request.skip_cache);
    message_ = serialized(message);
  }

  void prepare_job(const LoadRequest& request) {
    job_ = std::make_unique<JobCalls>();
    prepare(job_->create_context, request);
    prepare(job_->wait_context, request);
    v1::Job& job = *job_->create.mutable_job();
    *job.mutable_mesh() = request.message;
    job.set_display_name("tetstream-load");
    job.set_skip_cache(request.skip_cache);
  }

  void create_job() {
    server_.jobs.async()->CreateJob(&job_->create_context, &job_->create, &job_->job,
                                    [this](const grpc::Status& status) { created(status); });
  }

  void created(const grpc::Status& status) {
    if (!status.ok()) return end(to_absl(status));
    outcome_.header = Clock::now();
    job_->wait.set_name(job_->job.name());
    server_.jobs.async()->WaitJob(&job_->wait_context, &job_->wait, &job_->job,
                                  [this](const grpc::Status& waited) { finished(waited); });
  }

  void finished(const grpc::Status& status) {
    if (!status.ok()) return end(to_absl(status));
    if (job_->job.has_error()) return end(error_of(job_->job));
    v1::ReadJobResultRequest message;
    message.set_name(job_->job.name());
    message_ = serialized(message);
    read("/ReadJobResult", v1::JobService::service_full_name());
  }

  void read(const char* method, const char* service) {
    context_.set_initial_metadata_corked(true);  // sent with the request
    server_.streams.PrepareBidiStreamingCall(&context_, absl::StrCat("/", service, method), {},
                                             this);
    StartWriteLast(&message_, grpc::WriteOptions());
    StartRead(&event_);
    StartCall();
  }

  void OnReadDone(bool ok) override {
    if (!ok) return;  // OnDone tells why
    const TimePoint now = Clock::now();
    const std::uint64_t tets = check_.tets(), bytes = check_.column_bytes();
    outcome_.status = check_.take(event_);
    if (check_.has_header() && !outcome_.header) outcome_.header = now;
    if (check_.chunks() > 0 && !outcome_.first_chunk) outcome_.first_chunk = now;
    book_.count(check_.tets() - tets, check_.column_bytes() - bytes);
    if (!outcome_.status.ok()) return context_.TryCancel();
    StartRead(&event_);
  }

  void OnDone(const grpc::Status& status) override {
    absl::Status ended = outcome_.status;
    if (ended.ok()) ended = to_absl(status);
    if (ended.ok()) ended = check_.ended();
    end(ended);
  }

  void end(const absl::Status& status) {
    outcome_.ended = Clock::now();
    outcome_.status = status;
    outcome_.tets = check_.tets();
    outcome_.bytes = check_.column_bytes();
    CallBook& book = book_;
    book.forget(*this);
    const RequestSender::Done done = std::move(done_);
    const Outcome outcome = std::move(outcome_);
    delete this;
    done(outcome);
    book.left();
  }

  LoadServer& server_;
  CallBook& book_;
  RequestSender::Done done_;
  std::unique_ptr<JobCalls> job_;  ///< of a job
  grpc::ClientContext context_;    ///< of the stream
  grpc::ByteBuffer message_, event_;
  StreamCheck check_;
  Outcome outcome_;
};

}  // namespace

void begin_call(LoadServer& server,
                CallBook& book,
                const CallSettings& settings,
                const LoadRequest& request,
                RequestSender::Done done) {
  auto* call = new LoadCall(server, book, settings, request, std::move(done));
  book.enter(*call);
  call->start();
}

}  // namespace tet::load
