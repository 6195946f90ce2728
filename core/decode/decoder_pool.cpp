#include "core/decode/decoder_pool.h"

#include <algorithm>
#include <utility>

#include "core/base/failure_name.h"
#include "core/decode/find_decoder.h"

namespace tet {
namespace {

/// A machine that starts no program within this is not one to wait for.
constexpr std::chrono::seconds kStartTime{10};

/// Decoders that may die, before they have an order, without a request noticing.
constexpr int kAttempts = 3;

int thread_count(int processes) {
  if (processes > 0) return processes;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

absl::StatusOr<Decoder> start_decoder(const DecoderSettings& settings) {
  const absl::StatusOr<std::string> program = find_decoder(settings.program);
  if (!program.ok()) return program.status();
  return Decoder::start({*program, settings.environment});
}

/// Leaves `ready` empty where no decoder can be started.
void make_ready(const DecoderSettings& settings, std::optional<Decoder>& ready) {
  absl::StatusOr<Decoder> started = start_decoder(settings);
  if (started.ok()) ready.emplace(*std::move(started));
}

absl::StatusOr<Decoder> take_decoder(const DecoderSettings& settings,
                                     std::optional<Decoder>& ready) {
  if (!ready) return start_decoder(settings);
  Decoder taken = *std::move(ready);
  ready.reset();
  return taken;
}

absl::Status shutting_down() {
  return named_failure("SHUTTING_DOWN", absl::UnavailableError("the server is shutting down"));
}

absl::Status not_ready(const std::function<bool()>& cancelled) {
  if (cancelled && cancelled()) return absl::CancelledError("cancelled");
  return named_failure("DECODER_UNAVAILABLE",
                       absl::UnavailableError("the decoder program does not start"));
}

/// One attempt, with the decoder that stands ready, which is then used up, or with one of its
/// own.
absl::StatusOr<SealedBlock> attempt(const CheckedFile& checked,
                                    const DecoderSettings& settings,
                                    const std::function<bool()>& cancelled,
                                    std::optional<Decoder>& ready) {
  absl::StatusOr<Decoder> decoder = take_decoder(settings, ready);
  if (!decoder.ok()) return decoder.status();
  if (!decoder->wait_until_ready({kStartTime, cancelled})) return not_ready(cancelled);
  return decoder->decode(checked.order, checked.file.number(), {checked.limit, cancelled});
}

absl::StatusOr<SealedBlock> decode_request(const FileRequest& request,
                                           const DecoderSettings& settings,
                                           const std::function<bool()>& cancelled,
                                           std::optional<Decoder>& ready) {
  const absl::StatusOr<CheckedFile> checked = check_request(request, settings.max_time);
  if (!checked.ok()) return checked.status();
  absl::StatusOr<SealedBlock> block = absl::UnknownError("not decoded");
  for (int i = 0; i < kAttempts; ++i) {
    block = attempt(*checked, settings, cancelled, ready);
    if (!absl::IsUnavailable(block.status())) return block;
  }
  return block;
}

}  // namespace

DecoderPool::DecoderPool(DecoderSettings settings) : settings_(std::move(settings)) {
  for (int i = 0; i < thread_count(settings_.processes); ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

DecoderPool::~DecoderPool() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void DecoderPool::decode(FileRequest request, std::function<bool()> cancelled, Done done) {
  if (closing_) return done(shutting_down());
  const std::lock_guard lock(mutex_);
  jobs_.push_back({std::move(request), std::move(cancelled), std::move(done)});
  changed_.notify_one();
}

/// One decoder after another, each started before there is anything for it to do, and kept for
/// the next file when one is refused without it; a decoder ends with the thread that started
/// it, so the thread is as old as the pool.
void DecoderPool::work() {
  std::optional<Decoder> ready;
  while (true) {
    if (!ready) make_ready(settings_, ready);
    const std::optional<Job> job = next_job();
    if (!job) return;
    job->done(run(*job, ready));
  }
}

std::optional<DecoderPool::Job> DecoderPool::next_job() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closing_ || !jobs_.empty(); });
  if (jobs_.empty()) return std::nullopt;
  Job job = std::move(jobs_.front());
  jobs_.pop_front();
  return job;
}

absl::StatusOr<SealedBlock> DecoderPool::run(const Job& job, std::optional<Decoder>& ready) {
  const auto cancelled = [&] { return closing_ || (job.cancelled && job.cancelled()); };
  absl::StatusOr<SealedBlock> block = absl::CancelledError("cancelled");
  if (!cancelled()) block = decode_request(job.request, settings_, cancelled, ready);
  return closing_ && !block.ok() ? shutting_down() : std::move(block);
}

absl::StatusOr<SealedBlock> decode_once(const FileRequest& request,
                                        const DecoderSettings& settings,
                                        const std::function<bool()>& cancelled) {
  std::optional<Decoder> ready;
  make_ready(settings, ready);
  return decode_request(request, settings, cancelled, ready);
}

}  // namespace tet
