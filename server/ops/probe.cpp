#include "server/ops/probe.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/ops/guard.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kLookAtAnswer{500};

}  // namespace

Probe::Probe(std::string name, Ask ask, std::chrono::seconds interval)
    : name_(std::move(name)),
      ask_(std::move(ask)),
      interval_(interval),
      asking_([this](const std::stop_token& stopping) { work(stopping); }),
      watching_([this](const std::stop_token& stopping) { watch(stopping); }) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [&] { return has_answered_; });
  tell();
}

Probe::~Probe() {
  asking_.request_stop();
  watching_.request_stop();
}

absl::Status Probe::status() const {
  const std::lock_guard lock(mutex_);
  return status_now();
}

absl::Status Probe::status_now() const {
  if (!is_asking_ || Clock::now() - asked_ < kPatience) return answer_;
  const auto waited = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - asked_);
  return with_reason(absl::UnavailableError(absl::StrCat("no answer for ", waited.count(),
                                                         " seconds: the disk may hang")),
                     "NO_ANSWER");
}

void Probe::work(const std::stop_token& stopping) {
  while (!stopping.stop_requested()) {
    {
      const std::lock_guard lock(mutex_);
      is_asking_ = true;
      asked_ = Clock::now();
    }
    const absl::Status answer = guarded("a probe", ask_);
    std::unique_lock lock(mutex_);
    is_asking_ = false;
    has_answered_ = true;
    answer_ = answer;
    tell();
    changed_.notify_all();
    changed_.wait_for(lock, stopping, answer.ok() ? interval_ : kInTrouble,
                      [&] { return stopping.stop_requested(); });
  }
}

/// Tells of answers that do not come.
void Probe::watch(const std::stop_token& stopping) {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, stopping, kLookAtAnswer,
                            [&] { return stopping.stop_requested(); })) {
    tell();
  }
}

/// Logs what has changed. The mutex is held.
void Probe::tell() {
  const absl::Status now = status_now();
  if (now.ok() != was_down_) return;
  was_down_ = !now.ok();
  if (now.ok()) return log_event(spdlog::level::info, absl::StrCat(name_, "_up"));
  log_event(spdlog::level::err, absl::StrCat(name_, "_down"),
            {{"reason", reason_of(now)}, {"message", std::string(now.message())}});
}

}  // namespace tet
