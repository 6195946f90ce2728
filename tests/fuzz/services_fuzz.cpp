// Whole services in one process, over a real store: messages of every method, whatever they
// hold, are answered with what docs/errors.md says, and what the store keeps of them can be
// told again, also by a server that is started anew.
//
// An input is a byte, which may ask for another server, then messages: a byte that says of
// which method, two with the length (little-endian), and so many bytes. A message whose first
// byte has its highest bit is a further one of the call before. What parses has names put in:
// "@ball" and "@labels" are grids that there are, "@data" is the one whose bytes a call uploads
// or the last has uploaded, "@job0" to "@job7" are jobs that the input has created.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/fuzzed_services.h"
#include "tetstream/v1/grids.pb.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet::services_fuzz {
namespace {

namespace v1 = ::tetstream::v1;

// An input takes as long as its calls may, and what reading back does. First inputs show that
// every method is answered, however slow the machine is.
#ifdef TET_LIBFUZZER
constexpr std::chrono::milliseconds kAllCalls{600}, kOneCall{200}, kOneWatch{40};
#else
constexpr std::chrono::seconds kAllCalls{800}, kOneCall{600}, kOneWatch{600};
#endif
constexpr std::chrono::seconds kGenerous{600};
constexpr std::size_t kMostMessages = 24;
constexpr std::uint8_t kGoesOn = 0x80;
/// What an input begins with whose store is read by another server: few, as that takes a while.
constexpr std::uint8_t kRestart = 'R';

/// Each text of this message alone may become another one.
template <class Change>
void change_texts(pb::Message& message, const Change& change) {
  std::vector<const pb::FieldDescriptor*> fields;
  const pb::Reflection& reflection = *message.GetReflection();
  reflection.ListFields(message, &fields);
  for (const auto* field : fields) {
    if (field->type() != pb::FieldDescriptor::TYPE_STRING) continue;
    if (!field->is_repeated()) {
      std::string text = reflection.GetString(message, field);
      if (change(text)) reflection.SetString(&message, field, std::move(text));
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      std::string text = reflection.GetRepeatedString(message, field, i);
      if (change(text)) reflection.SetRepeatedString(&message, field, i, std::move(text));
    }
  }
}

/// One input's calls.
class Calls {
 public:
  explicit Calls(Services& services) : services_(services) {}

  void make(std::uint8_t which, std::vector<std::string> messages) {
    const auto left = end_ - Clock::now();
    if (left <= std::chrono::milliseconds(0)) return;
    const auto& method = method_of(kMethods[(which & ~kGoesOn) % kMethods.size()]);
    name_data(method, messages);
    for (std::string& message : messages) put_names_in(*method.input_type(), message);
    const bool watches = method.name().starts_with("Watch");
    const Clock::duration most = watches ? kOneWatch : kOneCall;
    const Clock::time_point deadline = Clock::now() + std::min<Clock::duration>(left, most);
    check(method, services_.call(method, messages, deadline, watches ? 1 : kMostAnswers));
  }

  /// Everything that is stored can be told, whoever has stored it; and goes.
  void read_back(bool restart) {
    std::vector<std::string> jobs = list_jobs();
    if (restart) {
      services_.restart();
      require(list_jobs() == jobs);
    }
    for (const std::string& name : jobs) {
      v1::GetJobRequest get;
      get.set_name(name);
      const auto job = services_.ask<v1::Job>("tetstream.v1.JobService.GetJob", get);
      require(job.name() == name);
      v1::ListDeadShardsRequest shards;
      shards.set_name(name);
      services_.ask<v1::ListDeadShardsResponse>("tetstream.v1.JobService.ListDeadShards",
                                                shards);
    }
    list_grids();
    services_.ask<v1::ListWorkersResponse>("tetstream.v1.JobService.ListWorkers",
                                           v1::ListWorkersRequest());
    for (const std::string& name : jobs) remove(name);
  }

 private:
  void check(const pb::MethodDescriptor& method, const Answer& answer) {
    for (const auto& message : answer.messages) {
      if (method.name() != "CreateJob") break;
      jobs_.push_back(static_cast<const v1::Job&>(*message).name());
    }
    switch (answer.status.error_code()) {
      case grpc::StatusCode::OK:
      case grpc::StatusCode::CANCELLED:
      case grpc::StatusCode::DEADLINE_EXCEEDED:
        return;
      case grpc::StatusCode::UNKNOWN:
      case grpc::StatusCode::INTERNAL:
      case grpc::StatusCode::UNIMPLEMENTED:
      case grpc::StatusCode::DATA_LOSS:
      case grpc::StatusCode::UNAUTHENTICATED:
      case grpc::StatusCode::PERMISSION_DENIED:
        std::fprintf(stderr, "%s: %d %s\n", method.full_name().c_str(),
                     answer.status.error_code(), answer.status.error_message().c_str());
        std::abort();
      default:
        require(!answer.status.error_message().empty());
    }
  }

  /// The bytes that a call uploads have a name.
  void name_data(const pb::MethodDescriptor& method, const std::vector<std::string>& messages) {
    if (method.name() != "UploadGrid") return;
    std::string content;
    for (const std::string& bytes : messages) {
      v1::UploadGridRequest message;
      if (message.ParseFromString(bytes)) content += message.data().data();
    }
    data_ = grid_name_of(content);
  }

  void put_names_in(const pb::Descriptor& type, std::string& bytes) const {
    const auto message = message_of(type);
    if (!message->ParseFromString(bytes)) return;  // it is sent as it is
    bool changed = false;
    const auto change = [&](std::string& text) {
      const std::string name = name_for(text);
      if (name.empty()) return false;
      text = name;
      return changed = true;
    };
    for_each_message(*message, [&](pb::Message& one) { change_texts(one, change); });
    if (changed) bytes = message->SerializeAsString();
  }

  std::string name_for(std::string_view text) const {
    static const std::string ball = grid_name_of(ball_file()),
                             labels = grid_name_of(labels_file());
    if (text == "@ball") return ball;
    if (text == "@labels") return labels;
    if (text == "@data") return data_;
    constexpr std::string_view kJob = "@job";
    if (!text.starts_with(kJob) || text.size() != kJob.size() + 1) return "";
    const auto number = static_cast<std::size_t>(text.back() - '0');
    return number < jobs_.size() ? jobs_[number] : "";
  }

  std::vector<std::string> list_jobs() {
    std::vector<std::string> names;
    v1::ListJobsRequest request;
    do {
      const auto page =
          services_.ask<v1::ListJobsResponse>("tetstream.v1.JobService.ListJobs", request);
      for (const v1::Job& job : page.jobs()) names.push_back(job.name());
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
    return names;
  }

  void list_grids() {
    v1::ListGridsRequest request;
    do {
      const auto page =
          services_.ask<v1::ListGridsResponse>("tetstream.v1.GridService.ListGrids", request);
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
  }

  /// One that ended meanwhile cannot be cancelled, and a later input finds it.
  void remove(const std::string& name) {
    v1::CancelJobRequest cancel;
    cancel.set_name(name);
    v1::DeleteJobRequest forget;
    forget.set_name(name);
    const auto ask = [&](const char* method, const pb::Message& request) {
      services_.call(method_of(method), {request.SerializeAsString()},
                     Clock::now() + kGenerous);
    };
    ask("tetstream.v1.JobService.CancelJob", cancel);
    ask("tetstream.v1.JobService.DeleteJob", forget);
  }

  Services& services_;
  const Clock::time_point end_ = Clock::now() + kAllCalls;
  std::vector<std::string> jobs_;
  std::string data_;
};

Services& services() {
  static Services instance;
  return instance;
}

}  // namespace

#ifndef TET_LIBFUZZER
static const bool kIsChecked =
    replay_checks().emplace("services_fuzz", [] { services().check_all_answered(); }).second;
#else
/// Leaks are not looked for after each input: the server's threads hold things at any moment.
// NOLINTNEXTLINE(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

/// The first input does not wait for the server's start.
extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  services();
  return 0;
}
#endif

TET_FUZZ_TARGET(services_fuzz) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  if (rest.empty()) return 0;
  const auto begin = static_cast<std::uint8_t>(rest.front());
  rest.remove_prefix(1);
  Calls calls(services());
  constexpr std::size_t kHead = 3;
  std::vector<std::string> messages;
  std::uint8_t which = 0;
  for (std::size_t made = 0; made < kMostMessages && rest.size() >= kHead; ++made) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(rest[i]); };
    const std::uint8_t first = byte(0);
    const std::size_t length = byte(1) + std::size_t{256} * byte(2);
    if ((first & kGoesOn) == 0 && !messages.empty()) {
      calls.make(which, std::exchange(messages, {}));
    }
    if ((first & kGoesOn) == 0) which = first;
    messages.emplace_back(rest.substr(kHead, length));
    rest.remove_prefix(std::min(rest.size(), kHead + length));
  }
  if (!messages.empty()) calls.make(which, std::move(messages));
  calls.read_back(begin == kRestart);
  return 0;
}

}  // namespace tet::services_fuzz
