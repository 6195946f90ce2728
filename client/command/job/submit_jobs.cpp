#include "client/command/job/submit_jobs.h"

#include <atomic>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>

#include "client/command/arguments/scene_input.h"
#include "client/command/mesh/grid_uploads.h"
#include "client/library/client_call.h"
#include "client/library/error_details.h"
#include "client/library/thrown_status.h"
#include "core/base/printable.h"

namespace tet {
namespace {

/// Whether other orders may still be accepted.
bool is_about_the_order(const absl::Status& status) {
  return absl::IsInvalidArgument(status) || absl::IsNotFound(status) ||
         absl::IsFailedPrecondition(status) || absl::IsAlreadyExists(status);
}

/// Orders that are alike are told apart by their number.
std::vector<std::string> request_ids_of(const std::vector<JobOrder>& orders,
                                        const Journal& journal) {
  std::map<std::string, std::size_t> seen;
  std::vector<std::string> ids;
  for (const JobOrder& order : orders) {
    const std::string digest = digest_of(order);
    ids.push_back(journal.request_id(digest, seen[digest]++));
  }
  return ids;
}

/// Tells the request what it is about, which is stored then.
template <class Store>
absl::Status store_input(const MeshInput& input, const Store& store, v1::MeshRequest& mesh) {
  if (is_scene_file(input.path)) {
    auto scene = read_scene_message(input.path, [&](const std::string& path) {
      return store({path, {}, {}});
    });
    if (scene.ok()) *mesh.mutable_scene() = std::move(*scene);
    return scene.status();
  }
  auto name = store(input);
  if (name.ok()) mesh.set_name(std::move(*name));
  return name.status();
}

/// Replaces the paths of the request's fields by the names of the stored files.
template <class Store>
absl::Status store_fields(const Store& store, v1::MeshRequest& mesh) {
  for (v1::Field& field : *mesh.mutable_fields()) {
    if (field.grid().empty()) continue;
    auto name = store({field.grid(), {}, {}});
    if (!name.ok()) return name.status();
    field.set_grid(*std::move(name));
  }
  return absl::OkStatus();
}

class Submitter {
 public:
  Submitter(const std::vector<JobOrder>& orders,
            const JobServer& server,
            Journal& journal,
            int parallel,
            const SubmitWatch& watch,
            const Cancellation& cancellation)
      : orders_(orders),
        request_ids_(request_ids_of(orders, journal)),
        uploads_(server.meshes),
        jobs_(server.jobs),
        journal_(journal),
        watch_(watch),
        cancellation_(cancellation),
        uploading_(static_cast<std::size_t>(parallel)) {}

  SubmitResult run() {
    std::vector<std::jthread> workers;
    for (std::size_t i = 0; i < uploading_.size() && start(workers, i); ++i) {
    }
    workers.clear();  // waits for them
    const bool all_done = next_.load() >= orders_.size();
    if (result_.status.ok() && !all_done) result_.status = check(cancellation_);
    return result_;
  }

 private:
  /// False where the system gives no more threads: fewer do the same.
  bool start(std::vector<std::jthread>& workers, std::size_t worker) {
    try {
      workers.emplace_back([this, worker] { work_contained(worker); });
      return true;
    } catch (...) {
      if (workers.empty()) stop(status_of_exception());
      return false;
    }
  }

  /// What is thrown out of a thread would end the process without a word.
  void work_contained(std::size_t worker) {
    try {
      work(worker);
    } catch (...) {
      stop(status_of_exception());
    }
  }

  void work(std::size_t worker) {
    while (!stopped_.load() && !cancellation_.requested()) {
      const std::size_t i = next_.fetch_add(1);
      if (i >= orders_.size()) return;
      if (const auto known = journal_.job_of(request_ids_[i])) {
        submitted({orders_[i], request_ids_[i], *known, true});
      } else {
        submit(worker, i);
      }
    }
  }

  void submit(std::size_t worker, std::size_t i) {
    auto job = create(worker, i);
    if (reason_of_failure(job.status()) == "GRID_NOT_FOUND") {  // evicted in between
      job = create(worker, i, true);
    }
    absl::Status status = job.status();
    if (status.ok()) status = journal_.record(request_ids_[i], job->name());
    if (status.ok()) {
      submitted({orders_[i], request_ids_[i], job->name(), false});
    } else if (is_about_the_order(status)) {
      refused(orders_[i], status);
    } else {
      stop(status);
    }
    progress(worker, 0);
  }

  /// Once its files are stored; where they are gone `anew`.
  absl::StatusOr<v1::Job> create(std::size_t worker, std::size_t i, bool anew = false) {
    const UploadWatch watch{
        .bytes =
            [&](std::uint64_t done, std::uint64_t total) {
              progress(worker, static_cast<double>(done) / static_cast<double>(total));
            },
        .converted =
            [&](const ConversionReport& report) {
              watch_.say(absl::StrCat(for_terminal(orders_[i].input.path), ": ",
                                      describe_conversion(report)));
            }};
    const auto store = [&](const MeshInput& input) {
      if (anew) uploads_.forget(input);
      return uploads_.name_of(input, watch, cancellation_);
    };
    v1::Job job = orders_[i].job;
    absl::Status stored = store_input(orders_[i].input, store, *job.mutable_mesh());
    if (stored.ok()) stored = store_fields(store, *job.mutable_mesh());
    if (!stored.ok()) return stored;
    return jobs_.create(job, request_ids_[i], cancellation_);
  }

  void submitted(const SubmittedJob& job) {
    const std::lock_guard lock(mutex_);
    ++(job.before ? result_.counts.before : result_.counts.submitted);
    watch_.submitted(job);
  }

  void refused(const JobOrder& order, const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    ++result_.counts.refused;
    watch_.refused(order, status);
  }

  void stop(const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    stopped_.store(true);
    if (result_.status.ok()) result_.status = status;
  }

  void progress(std::size_t worker, double uploaded) {
    const std::lock_guard lock(mutex_);
    uploading_[worker] = uploaded;
    const auto& [submitted, before, refused] = result_.counts;
    watch_.progress(std::accumulate(uploading_.begin(), uploading_.end(),
                                    static_cast<double>(submitted + before + refused)));
  }

  const std::vector<JobOrder>& orders_;
  const std::vector<std::string> request_ids_;
  GridUploads uploads_;
  JobClient& jobs_;
  Journal& journal_;
  const SubmitWatch& watch_;
  const Cancellation& cancellation_;

  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::vector<double> uploading_;  ///< of each worker's file, how much is there
  SubmitResult result_;
};

}  // namespace

SubmitResult submit_jobs(const std::vector<JobOrder>& orders,
                         const JobServer& server,
                         Journal& journal,
                         int parallel,
                         const SubmitWatch& watch,
                         const Cancellation& cancellation) {
  return Submitter(orders, server, journal, parallel, watch, cancellation).run();
}

}  // namespace tet
