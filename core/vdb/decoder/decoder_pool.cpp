#include "core/vdb/decoder/decoder_pool.h"

#include <algorithm>
#include <utility>

#include <absl/functional/function_ref.h>

#include "core/base/contain.h"
#include "core/base/failure_name.h"

namespace tet {
namespace {

/// Decoders that may die, before they have an order, without a request noticing.
constexpr int kAttempts = 3;

int thread_count(int processes) {
  if (processes > 0) return processes;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

using TakeDecoder = absl::FunctionRef<absl::StatusOr<Decoder>()>;

absl::Status shutting_down() {
  return named_failure("SHUTTING_DOWN", absl::UnavailableError("the server is shutting down"));
}

absl::StatusOr<SealedBlock> attempt(const CheckedFile& checked,
                                    std::chrono::milliseconds limit,
                                    TakeDecoder take,
                                    const std::function<bool()>& cancelled) {
  absl::StatusOr<Decoder> decoder = take();
  if (!decoder.ok()) return decoder.status();
  if (auto ready = decoder->wait_until_ready(cancelled); !ready.ok()) return ready;
  return decoder->decode(checked.order, checked.file.number(), {limit, cancelled});
}

absl::StatusOr<SealedBlock> decode_request(const FileRequest& request,
                                           const DecoderSettings& settings,
                                           TakeDecoder take,
                                           const std::function<bool()>& cancelled) {
  const std::chrono::milliseconds most = settings.max_time;
  const absl::StatusOr<CheckedFile> checked = check_request(request, most, cancelled);
  if (!checked.ok()) return checked.status();
  const auto limit = std::min(std::max(checked->limit, settings.least_time), most);
  absl::StatusOr<SealedBlock> block = absl::UnknownError("not decoded");
  for (int i = 0; i < kAttempts; ++i) {
    block = attempt(*checked, limit, take, cancelled);
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

void DecoderPool::decode(const std::string& client,
                         FileRequest request,
                         std::function<bool()> cancelled,
                         Done done) {
  if (closing_) return done(shutting_down());
  const std::lock_guard lock(mutex_);
  jobs_.push(client, {client, std::move(request), std::move(cancelled), std::move(done)});
  changed_.notify_one();
}

/// A decoder ends with the thread that started it, so the thread is as old as the pool.
void DecoderPool::work() {
  DecoderSupply supply(settings_.program);
  while (true) {
    // Before there is anything for it to do.
    supply.prepare([this] { return closing_.load(); });
    const std::optional<Job> job = next_job();
    if (!job) return;
    const auto start = std::chrono::steady_clock::now();
    contain("a decoder's thread", [&] {
      job->done(run_contained(*job, supply));
      charge(*job, std::chrono::steady_clock::now() - start);
    });
  }
}

absl::StatusOr<SealedBlock> DecoderPool::run_contained(const Job& job, DecoderSupply& supply) {
  try {
    return run(job, supply);
  } catch (...) {
    tell_exception("a decoder's thread");
    return absl::InternalError("the server failed in reading the file");
  }
}

std::optional<DecoderPool::Job> DecoderPool::next_job() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closing_ || jobs_.size() > 0; });
  return jobs_.take([](const std::string&) { return true; });
}

void DecoderPool::charge(const Job& job, std::chrono::nanoseconds use) {
  const std::lock_guard lock(mutex_);
  jobs_.charge(job.client, use);
}

absl::StatusOr<SealedBlock> DecoderPool::run(const Job& job, DecoderSupply& supply) {
  const auto cancelled = [&] { return closing_ || (job.cancelled && job.cancelled()); };
  const auto take = [&] { return supply.take(cancelled); };
  absl::StatusOr<SealedBlock> block = absl::CancelledError("cancelled");
  if (!cancelled()) {
    block = decode_request(job.request, settings_, take, cancelled);
    if (failure_name(block.status()) == "DECODER_CRASHED") supply.start_anew();
  }
  return closing_ && !block.ok() ? shutting_down() : std::move(block);
}

absl::StatusOr<SealedBlock> decode_once(const FileRequest& request,
                                        const DecoderSettings& settings,
                                        const std::function<bool()>& cancelled) {
  const auto start = [&] { return Decoder::start(settings.program); };
  // It gets ready while the file is walked over.
  std::optional<absl::StatusOr<Decoder>> first(start());
  const auto take = [&] {
    if (!first) return start();
    return *std::exchange(first, std::nullopt);
  };
  return decode_request(request, settings, take, cancelled);
}

}  // namespace tet
