// Calls about jobs, as their messages' bytes: each is refused with a reason or done, and what a
// store keeps of it can be told again, within what the wire can say.
//
// An input is a list of calls: a byte that says which, two with the length (little-endian), and
// so many bytes of the message. Rows that others have written are calls too.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "proto/convert/status.h"
#include "proto/convert/times.h"
#include "server/jobs/service/job_messages.h"
#include "server/jobs/store/job_rows.h"
#include "server/jobs/store/open_job_store.h"
#include "server/jobs/store/sqlite_job_store.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::job_messages_fuzz {
namespace {

constexpr char kSpace[] = "default";
constexpr std::size_t kMostCalls = 16;

template <class Message>
void require_within_range(const Message& message) {
  const Message bounded = within_range(message);
  require(bounded.seconds() == message.seconds() && bounded.nanos() == message.nanos());
}

/// A refusal is the caller's affair: none of these can break a store.
void check_refusal(const absl::Status& status) {
  require(absl::IsInvalidArgument(status) || absl::IsOutOfRange(status) ||
          absl::IsNotFound(status) || absl::IsAlreadyExists(status) ||
          absl::IsFailedPrecondition(status));
  require(to_grpc(status).error_details().size() <= kMaxStatusBytes);
}

void check_told(const Job& job) {
  v1::Job told;
  to_proto(job, true, told);
  if (told.has_ttl()) require_within_range(told.ttl());
  if (told.has_timeout()) require_within_range(told.timeout());
  if (told.progress().has_eta()) require_within_range(told.progress().eta());
  require_within_range(told.create_time());
  if (told.has_start_time()) require_within_range(told.start_time());
  if (told.has_finish_time()) require_within_range(told.finish_time());
  if (told.has_stop_time()) require_within_range(told.stop_time());
  require(!text_of(told.create_time()).empty());
}

class Calls {
 public:
  Calls() : jobs_(*open_sqlite_job_store({.path = ":memory:"})) {}

  void make(std::uint8_t which, const std::string& bytes) {
    switch (which % 6) {
      case 0:
        return create(bytes);
      case 1:
        return list(bytes);
      case 2:
        return wait(bytes);
      case 3:
        return watch(bytes);
      case 4:
        workers(bytes);
        return dead_shards(bytes);
      default:
        return row(bytes);
    }
  }

  void check_all() {
    const auto page =
        jobs_->list({.filter = {.space = kSpace}, .page_size = 1000, .page_token = ""});
    require(page.ok());
    for (const Job& job : page->jobs) {
      check_told(job);
      const auto again = jobs_->get(job.id);
      require(again.ok());
      check_told(*again);
    }
    require(jobs_->expire().ok() && jobs_->rescue().ok() && jobs_->counts().ok());
  }

 private:
  void create(const std::string& bytes) {
    v1::CreateJobRequest message;
    if (!message.ParseFromString(bytes)) return;
    const auto wanted = parse_create(message, kSpace);
    if (!wanted.ok()) return check_refusal(wanted.status());
    const auto created = jobs_->create(*wanted);
    if (!created.ok()) return check_refusal(created.status());
    check_told(created->job);
    // It runs, and its timeout begins.
    const auto leases = jobs_->claim({"worker", 10, absl::Seconds(30)});
    require(leases.ok());
  }

  void list(const std::string& bytes) {
    v1::ListJobsRequest message;
    if (!message.ParseFromString(bytes)) return;
    const auto query = parse_list(message, kSpace);
    if (!query.ok()) return check_refusal(query.status());
    const auto page = jobs_->list(*query);
    if (!page.ok()) return check_refusal(page.status());
    for (const Job& job : page->jobs) check_told(job);
  }

  static void wait(const std::string& bytes) {
    v1::WaitJobRequest message;
    if (!message.ParseFromString(bytes)) return;
    const auto time = parse_wait(message);
    if (!time.ok()) return check_refusal(time.status());
    require(*time >= absl::ZeroDuration() && *time <= absl::Hours(1));
  }

  void watch(const std::string& bytes) {
    v1::WatchJobsRequest message;
    if (!message.ParseFromString(bytes)) return;
    WatchJobs query;
    query.space = kSpace;
    query.after_revision = message.after_revision();
    const auto page = jobs_->watch(query);
    if (!page.ok()) return check_refusal(page.status());
    for (const JobEvent& event : page->events) {
      v1::JobEvent told;
      to_proto(event, told);
      require_within_range(told.time());
    }
  }

  static void dead_shards(const std::string& bytes) {
    v1::ListDeadShardsRequest message;
    if (!message.ParseFromString(bytes)) return;
    const auto size = parse_page_size(message.page_size());
    const auto first = parse_shard_token(message.page_token());
    if (!size.ok()) return check_refusal(size.status());
    if (!first.ok()) return check_refusal(first.status());
    require(*size >= 1 && *size <= 1000 && *first >= 0 && *first + *size > *first);
  }

  void workers(const std::string& bytes) {
    v1::ListWorkersRequest message;
    if (!message.ParseFromString(bytes)) return;
    const auto size = parse_page_size(message.page_size());
    const auto after = parse_worker_token(message.page_token());
    if (!size.ok()) return check_refusal(size.status());
    if (!after.ok()) return check_refusal(after.status());
    const auto page = jobs_->workers({kSpace, *size, *after});
    require(page.ok() && page->is_last && page->workers.empty());
  }

  /// A row whose numbers nobody of ours has written, in the order of select_jobs.
  static void row(std::string_view bytes) {
    const auto number = [&] {
      std::int64_t value = 0;
      const std::size_t size = std::min(bytes.size(), sizeof value);
      std::memcpy(&value, bytes.data(), size);
      bytes.remove_prefix(size);
      return value;
    };
    const std::string id(24, '0');
    std::vector<SqlValue> values{id, std::string(kSpace), Blob{}, std::string("\nkey")};
    constexpr int kBeforeError = 5, kAfterError = 14;
    for (int i = 0; i < kBeforeError; ++i) values.emplace_back(number());
    values.emplace_back(Blob{std::string(bytes)});
    for (int i = 0; i < kAfterError; ++i) values.emplace_back(number());
    values.emplace_back(std::string("algorithm"));
    for (int i = 0; i < 2; ++i) values.emplace_back(number());  // replans, shards given back
    values.emplace_back(Blob{std::string(bytes)});              // why they were
    for (int i = 0; i < 2; ++i) values.emplace_back(number());  // looks for room, leased shards
    values.emplace_back(Blob{std::string(bytes)});
    values.emplace_back(Blob{std::string(bytes)});
    check_told(job_row(SqlRow(std::move(values))).job);
  }

  std::unique_ptr<JobStore> jobs_;
};

}  // namespace

TET_FUZZ_TARGET(job_messages_fuzz) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  Calls calls;
  constexpr std::size_t kHead = 3;
  for (std::size_t made = 0; made < kMostCalls && rest.size() >= kHead; ++made) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(rest[i]); };
    const std::size_t length = byte(1) + std::size_t{256} * byte(2);
    calls.make(byte(0), std::string(rest.substr(kHead, length)));
    rest.remove_prefix(std::min(rest.size(), kHead + length));
  }
  calls.check_all();
  return 0;
}

}  // namespace tet::job_messages_fuzz
