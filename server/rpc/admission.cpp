#include "server/rpc/admission.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/check.h"
#include "proto/convert/status.h"

namespace tet {

namespace {

constexpr absl::Duration kBusyRetryDelay = absl::Seconds(1);
constexpr char kWaitingMeshes[] = "meshes waiting for their turn";

absl::Status busy(const std::string& what, std::uint64_t value, std::uint64_t limit) {
  return with_retry(over_limit(what, value, limit, "SERVER_BUSY"), kBusyRetryDelay);
}

}  // namespace

absl::Status shutting_down() {
  return with_retry(
      with_reason(absl::UnavailableError("the server is shutting down"), "SHUTTING_DOWN"),
      kBusyRetryDelay);
}

absl::Status Tally::check(const std::string& client) const {
  const std::uint64_t own = of(client) + 1;
  if (own > limit_.client) return over_quota(client, what_, own, limit_.client);
  if (all_ + 1 > limit_.all) return busy(what_, all_ + 1, limit_.all);
  return absl::OkStatus();
}

void Tally::add(const std::string& client) {
  ++all_;
  ++of_client_[client];
}

void Tally::remove(const std::string& client) {
  --all_;
  const auto found = of_client_.find(client);
  if (--found->second == 0) of_client_.erase(found);
}

void Tally::pause() {
  TET_CHECK(all_ > 0);
  --all_;
  ++paused_;
}

void Tally::resume() {
  TET_CHECK(paused_ > 0);
  ++all_;
  --paused_;
}

std::uint64_t Tally::of(const std::string& client) const {
  const auto found = of_client_.find(client);
  return found == of_client_.end() ? 0 : found->second;
}

Admission::Admission(const AdmissionLimits& limits)
    : limits_(limits),
      calls_("calls at once", limits.calls),
      uploads_("uploads at once", limits.uploads),
      meshes_("meshes being made at once", limits.meshes) {}

absl::StatusOr<Ticket> Admission::admit_call(const std::string& client) {
  return admit(calls_, client);
}

absl::StatusOr<Ticket> Admission::admit_upload(const std::string& client) {
  return admit(uploads_, client);
}

absl::StatusOr<Ticket> Admission::admit(Tally& tally, const std::string& client) {
  const std::lock_guard lock(mutex_);
  if (draining_) return shutting_down();
  if (auto status = tally.check(client); !status.ok()) return status;
  return ticket_for(tally, client);
}

Ticket Admission::ticket_for(Tally& tally, const std::string& client) {
  tally.add(client);
  return {&tally,
          [this, client](void* counted) { give_back(*static_cast<Tally*>(counted), client); }};
}

/// What is given back may be what somebody waits for.
void Admission::give_back(Tally& tally, const std::string& client) {
  std::vector<Admitted> admitted;
  {
    const std::lock_guard lock(mutex_);
    tally.remove(client);
    admitted = admit_waiting();
  }
  for (Admitted& next : admitted) next.tell();
}

std::vector<Admission::Admitted> Admission::admit_waiting() {
  std::vector<Admitted> admitted;
  const auto fits = [&](const std::string& client) { return meshes_.check(client).ok(); };
  while (auto next = queue_.take(fits)) {
    admitted.push_back({std::move(next->answer), ticket_for(meshes_, next->client)});
  }
  return admitted;
}

// Whoever waits does so because there is no room for it, so nobody is overtaken here.
Admission::Place Admission::queue_mesh(const std::string& client,
                                       Clock::time_point deadline,
                                       Answer answer) {
  absl::StatusOr<Ticket> ticket = nullptr;
  std::optional<Waiting> displaced;
  Place place = 0;
  {
    const std::lock_guard lock(mutex_);
    absl::Status status = draining_ ? shutting_down() : meshes_.check(client);
    if (status.ok()) {
      ticket = ticket_for(meshes_, client);
      queue_.had_turn(client);
    } else {
      if (!draining_ && limits_.queued_meshes.all > 0) {
        displaced = make_room_for(client);
        status = check_queue(client);
      }
      if (status.ok()) {
        place = queue_.push(client, {client, deadline, Clock::now() + limits_.queue_time,
                                     std::exchange(answer, nullptr)});
      } else {
        ticket = std::move(status);
      }
    }
  }
  if (displaced) {
    const std::uint64_t all = limits_.queued_meshes.all;
    displaced->answer(busy(kWaitingMeshes, all + 1, all));
  }
  if (place == 0) answer(std::move(ticket));
  return place;
}

/// Takes out the last mesh of whoever has most waiting, if the queue is full and it is not this
/// client.
std::optional<Admission::Waiting> Admission::make_room_for(const std::string& client) {
  if (queue_.size() < limits_.queued_meshes.all) return std::nullopt;
  return queue_.take_last_beyond(queue_.size_of(client) + 1);
}

absl::Status Admission::check_queue(const std::string& client) const {
  const std::uint64_t own = queue_.size_of(client) + 1, all = queue_.size() + 1;
  const Share& limit = limits_.queued_meshes;
  if (own > limit.client) return over_quota(client, kWaitingMeshes, own, limit.client);
  if (all > limit.all) return busy(kWaitingMeshes, all, limit.all);
  return absl::OkStatus();
}

bool Admission::leave(Place place) {
  std::vector<Waiting> gone;  // destroyed without the lock
  const std::lock_guard lock(mutex_);
  gone = queue_.take_all([&](Place at, const Waiting&) { return at == place; });
  return !gone.empty();
}

std::function<void()> Admission::pause_mesh() {
  const std::lock_guard lock(mutex_);
  meshes_.pause();
  auto admitted = std::make_shared<std::vector<Admitted>>(admit_waiting());
  return [admitted] {
    for (Admitted& next : *admitted) next.tell();
  };
}

void Admission::resume_mesh() {
  const std::lock_guard lock(mutex_);
  meshes_.resume();
}

void Admission::expire(Clock::time_point now) {
  std::vector<Admitted> expired;
  {
    const std::lock_guard lock(mutex_);
    const auto due = [&](Place, const Waiting& w) {
      return w.deadline <= now || w.patience <= now;
    };
    for (Waiting& waiting : queue_.take_all(due)) {
      absl::Status why = why_expired(waiting, now);
      expired.push_back({std::move(waiting.answer), std::move(why)});
    }
  }
  for (Admitted& refused : expired) refused.tell();
}

absl::Status Admission::why_expired(const Waiting& waiting, Clock::time_point now) const {
  if (waiting.deadline <= now) {
    return with_reason(
        absl::DeadlineExceededError("the deadline passed before it was this mesh's turn"),
        "DEADLINE_EXCEEDED");
  }
  const absl::Status status = absl::ResourceExhaustedError(absl::StrCat(
      "it was not this mesh's turn within ", limits_.queue_time.count(), " s: ", meshes_.all(),
      " are being made, and ", queue_.size(), " more wait"));
  return with_retry(with_reason(status, "SERVER_BUSY"), kBusyRetryDelay);
}

void Admission::announce_end() {
  const std::lock_guard lock(mutex_);
  ending_ = true;
}

void Admission::drain() {
  std::vector<Waiting> waiting;
  {
    const std::lock_guard lock(mutex_);
    ending_ = draining_ = true;
    waiting = queue_.take_all([](Place, const Waiting&) { return true; });
  }
  for (const Waiting& refused : waiting) refused.answer(shutting_down());
}

bool Admission::is_ending() const {
  const std::lock_guard lock(mutex_);
  return ending_;
}

std::uint64_t Admission::running_meshes() const {
  const std::lock_guard lock(mutex_);
  return meshes_.all();
}

std::uint64_t Admission::paused_meshes() const {
  const std::lock_guard lock(mutex_);
  return meshes_.paused();
}

std::uint64_t Admission::queued_meshes() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

}  // namespace tet
