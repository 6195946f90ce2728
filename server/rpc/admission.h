// Who may do what now: limits on calls, uploads and meshes, and a fair queue for meshes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/fair_queue.h"

namespace tet {

/// How a call ends that a server which stops no longer takes, or no longer goes on with.
absl::Status shutting_down();

/// At most so many at once: in all, and of one client.
struct Share {
  std::uint64_t all = 0, client = 0;
};

struct AdmissionLimits {
  Share calls, uploads, meshes, queued_meshes;
  std::chrono::seconds queue_time{10};    ///< a mesh that waited so long is told to retry
  std::uint64_t client_upload_bytes = 0;  ///< of one client's unfinished uploads; see Uploader
};

/// Something that was admitted; counts until it is destroyed.
using Ticket = std::shared_ptr<void>;

/// Counts what runs against a share of it.
class Tally {
 public:
  /// `what` is named in refusals: "calls at once".
  Tally(std::string what, const Share& limit) : what_(std::move(what)), limit_(limit) {}

  /// OK where one more of this client fits. Errors: kResourceExhausted, with QuotaFailure over
  /// the client's own share, with RetryInfo over that of all.
  absl::Status check(const std::string& client) const;
  void add(const std::string& client);
  void remove(const std::string& client);
  /// One that was added counts for its client only; or for all again, whether it fits or not.
  void pause();
  void resume();

  std::uint64_t all() const noexcept { return all_; }
  std::uint64_t paused() const noexcept { return paused_; }
  std::uint64_t of(const std::string& client) const;

 private:
  const std::string what_;
  const Share limit_;
  std::uint64_t all_ = 0, paused_ = 0;
  std::map<std::string, std::uint64_t> of_client_;  ///< none is 0
};

/// Admits calls, uploads and meshes; meshes that find no room queue for it, and the clients
/// take turns.
///
/// Thread safety: any thread may call any member. Outlives its tickets.
class Admission {
 public:
  using Clock = Cancellation::Clock;
  using Answer = std::function<void(absl::StatusOr<Ticket>)>;
  using Place = FairQueue<int>::Place;

  explicit Admission(const AdmissionLimits& limits);

  const AdmissionLimits& limits() const noexcept { return limits_; }

  /// Errors: kUnavailable (draining), kResourceExhausted (see Tally::check).
  absl::StatusOr<Ticket> admit_call(const std::string& client);
  absl::StatusOr<Ticket> admit_upload(const std::string& client);

  /// Asks for a mesh to be made. `answer` is called once: here, if there is room or none to
  /// wait in, else later and on any thread. Where the queue is full, whoever has most waiting
  /// makes room for a client with less. Errors: kUnavailable (draining), kResourceExhausted
  /// (the queue is full, or got full behind it, the client's part of it is, or it took too
  /// long), kDeadlineExceeded (in the queue).
  Place queue_mesh(const std::string& client, Clock::time_point deadline, Answer answer);
  /// Gives up a place: its answer is not called any more. False when it was, or is being.
  bool leave(Place place);

  /// A mesh that was admitted has nothing to do for a while: its place goes to others, and only
  /// its client's share has it. Whoever holds its ticket comes back before giving that back.
  /// What is returned answers those who got the place: to be called once, without any lock,
  /// also where the mesh came back meanwhile.
  [[nodiscard]] std::function<void()> pause_mesh();
  void resume_mesh();

  /// Answers those who have waited for too long; to be called every now and then.
  void expire(Clock::time_point now);
  /// From now on it says that it will end, and takes all that comes: whoever balances the load
  /// sends less, and what it sends meanwhile is not refused.
  void announce_end();
  /// Refuses everything from now on, those in the queue first.
  void drain();
  /// Whether one of both was called: nothing new is welcome.
  bool is_ending() const;

  std::uint64_t running_meshes() const;
  std::uint64_t paused_meshes() const;
  std::uint64_t queued_meshes() const;

 private:
  struct Waiting {
    std::string client;
    Clock::time_point deadline;  ///< the client's
    Clock::time_point patience;  ///< ours
    Answer answer;
  };
  struct Admitted {
    Answer answer;
    absl::StatusOr<Ticket> ticket;
    void tell() { answer(std::move(ticket)); }
  };

  absl::StatusOr<Ticket> admit(Tally& tally, const std::string& client);
  Ticket ticket_for(Tally& tally, const std::string& client);
  absl::Status check_queue(const std::string& client) const;
  std::optional<Waiting> make_room_for(const std::string& client);
  absl::Status why_expired(const Waiting& waiting, Clock::time_point now) const;
  void give_back(Tally& tally, const std::string& client);
  std::vector<Admitted> admit_waiting();

  const AdmissionLimits limits_;
  mutable std::mutex mutex_;  ///< guards all below; never held while somebody is answered
  bool ending_ = false, draining_ = false;
  Tally calls_, uploads_, meshes_;
  FairQueue<Waiting> queue_;
};

}  // namespace tet
