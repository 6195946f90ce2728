#include "server/rpc/admission.h"

#include <atomic>
#include <deque>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr auto kNever = Admission::Clock::time_point::max();
constexpr char kRetryInfo[] = "type.googleapis.com/google.rpc.RetryInfo";
constexpr char kQuotaFailure[] = "type.googleapis.com/google.rpc.QuotaFailure";

AdmissionLimits roomy() {
  constexpr Share kMany{1000, 1000};
  return {kMany, kMany, kMany, kMany, 10s};
}

AdmissionLimits one_mesh_at_once() {
  AdmissionLimits limits = roomy();
  limits.meshes = {1, 1};
  return limits;
}

/// A mesh that was asked for.
struct Asked {
  absl::StatusOr<Ticket> answer = absl::UnknownError("not answered");
  Admission::Place place = 0;
  int answers = 0;
  bool runs() const { return answer.ok(); }
  void end() { answer = absl::UnknownError("ended"); }
};

Asked& ask(Admission& admission,
           std::deque<Asked>& all,
           const std::string& client,
           Admission::Clock::time_point deadline = kNever) {
  Asked& asked = all.emplace_back();
  asked.place = admission.queue_mesh(client, deadline, [&](absl::StatusOr<Ticket> answer) {
    asked.answer = std::move(answer);
    ++asked.answers;
  });
  return asked;
}

TEST(Admission, RunsWhatFitsAtOnceAndTheRestInTurn) {
  Admission admission(one_mesh_at_once());
  std::deque<Asked> all;
  Asked &first = ask(admission, all, "a"), &second = ask(admission, all, "a");
  EXPECT_TRUE(first.runs());
  EXPECT_FALSE(second.runs());
  EXPECT_EQ(admission.queued_meshes(), 1U);
  first.end();
  EXPECT_TRUE(second.runs());
  EXPECT_EQ(admission.running_meshes(), 1U);
}

TEST(Admission, AMeshThatHasNothingToDoLendsItsPlaceAndKeepsItsClientsShare) {
  AdmissionLimits limits = roomy();
  limits.meshes = {1, 1};
  Admission admission(limits);
  std::deque<Asked> all;
  Asked &idle = ask(admission, all, "a"), &own = ask(admission, all, "a"),
        &other = ask(admission, all, "b");
  admission.pause_mesh()();
  EXPECT_TRUE(other.runs());
  EXPECT_FALSE(own.runs()) << "its client has one already";
  EXPECT_EQ(admission.paused_meshes(), 1U);
  admission.resume_mesh();
  EXPECT_EQ(admission.running_meshes(), 2U) << "it does not ask";
  idle.end();
  EXPECT_FALSE(own.runs());
  other.end();
  EXPECT_TRUE(own.runs());
}

TEST(Admission, TakesAllThatComesWhileItsEndIsAnnounced) {
  Admission admission(one_mesh_at_once());
  EXPECT_FALSE(admission.is_ending());
  admission.announce_end();
  EXPECT_TRUE(admission.is_ending());
  EXPECT_TRUE(admission.admit_call("a").ok());
  std::deque<Asked> all;
  EXPECT_TRUE(ask(admission, all, "a").runs());
  admission.drain();
  EXPECT_TRUE(admission.is_ending());
  EXPECT_EQ(admission.admit_call("a").status().code(), absl::StatusCode::kUnavailable);
}

TEST(Admission, AHundredRequestsOfOneClientDoNotDelayOneOfAnother) {
  Admission admission(one_mesh_at_once());
  std::deque<Asked> greedy, modest;
  for (int i = 0; i < 101; ++i) ask(admission, greedy, "greedy");
  Asked& one = ask(admission, modest, "modest");
  greedy[0].end();
  EXPECT_TRUE(one.runs()) << "after the mesh that ran, not after the hundred that wait";
  admission.drain();
}

TEST(Admission, AClientAtItsOwnLimitLeavesRoomToOthers) {
  AdmissionLimits limits = roomy();
  limits.meshes = {3, 2};
  Admission admission(limits);
  std::deque<Asked> all;
  for (int i = 0; i < 5; ++i) ask(admission, all, "greedy");
  EXPECT_EQ(admission.running_meshes(), 2U);
  EXPECT_TRUE(ask(admission, all, "modest").runs());
  admission.drain();
}

TEST(Admission, InAFullQueueWhoeverHasMostMakesRoomForWhoHasLess) {
  AdmissionLimits limits = roomy();
  limits.meshes = {1, 1};
  limits.queued_meshes = {4, 4};
  Admission admission(limits);
  std::deque<Asked> all;
  Asked& first = ask(admission, all, "greedy");
  for (int i = 0; i < 4; ++i) ask(admission, all, i < 3 ? "greedy" : "other");
  Asked &modest = ask(admission, all, "modest"), &displaced = all[3];
  EXPECT_EQ(modest.answers, 0);
  EXPECT_EQ(displaced.answer.status().message(),
            "meshes waiting for their turn: 5 is over the limit of 4");
  EXPECT_TRUE(displaced.answer.status().GetPayload(kRetryInfo));
  EXPECT_EQ(admission.queued_meshes(), 4U);
  Asked& more = ask(admission, all, "greedy");
  EXPECT_EQ(more.answers, 1) << "nobody has more than it would";
  first.end();
  EXPECT_TRUE(all[4].runs() || modest.runs());
  admission.drain();  // nobody is answered once it is gone
}

TEST(Admission, SaysWhoseLimitItIs) {
  AdmissionLimits limits = one_mesh_at_once();
  limits.queued_meshes = {2, 1};
  limits.calls = {2, 1};
  Admission admission(limits);
  std::deque<Asked> all;
  for (const char* client : {"a", "a", "b"}) ask(admission, all, client);
  const absl::Status own = ask(admission, all, "a").answer.status();
  EXPECT_EQ(own.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(own.message(),
            "meshes waiting for their turn of one client: 2 is over the limit of 1");
  EXPECT_TRUE(own.GetPayload(kQuotaFailure));
  const absl::Status everyone = ask(admission, all, "c").answer.status();
  EXPECT_EQ(everyone.message(), "meshes waiting for their turn: 3 is over the limit of 2");
  EXPECT_TRUE(everyone.GetPayload(kRetryInfo));
  EXPECT_FALSE(everyone.GetPayload(kQuotaFailure));
  const auto call = admission.admit_call("a");
  EXPECT_TRUE(admission.admit_call("a").status().GetPayload(kQuotaFailure));
  admission.drain();
}

TEST(Admission, WithoutAQueueRefusesAtOnce) {
  AdmissionLimits limits = one_mesh_at_once();
  limits.meshes.client = 2;
  limits.queued_meshes = {};
  Admission admission(limits);
  std::deque<Asked> all;
  EXPECT_TRUE(ask(admission, all, "a").runs());
  EXPECT_EQ(ask(admission, all, "b").answer.status().message(),
            "meshes being made at once: 2 is over the limit of 1");
}

TEST(Admission, WhoeverLeavesTheQueueIsGoneAtOnce) {
  Admission admission(one_mesh_at_once());
  std::deque<Asked> all;
  Asked &runs = ask(admission, all, "a"), &leaves = ask(admission, all, "a"),
        &stays = ask(admission, all, "a");
  EXPECT_TRUE(admission.leave(leaves.place));
  EXPECT_EQ(admission.queued_meshes(), 1U);
  runs.end();
  EXPECT_EQ(leaves.answers, 0);
  EXPECT_TRUE(stays.runs());
  EXPECT_FALSE(admission.leave(stays.place)) << "it was answered";
}

TEST(Admission, AnswersADeadlineInTheQueue) {
  Admission admission(one_mesh_at_once());
  std::deque<Asked> all;
  const auto now = Admission::Clock::now();
  ask(admission, all, "a");
  Asked &hasty = ask(admission, all, "a", now + 1s), &patient = ask(admission, all, "a");
  admission.expire(now + 2s);
  EXPECT_EQ(hasty.answer.status().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(patient.answers, 0);
  admission.expire(now + 11s);
  EXPECT_EQ(patient.answer.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(patient.answer.status().message()), HasSubstr("within 10 s"));
  EXPECT_TRUE(patient.answer.status().GetPayload(kRetryInfo));
}

TEST(Admission, DrainRefusesTheQueuedAndAllThatComes) {
  Admission admission(one_mesh_at_once());
  std::deque<Asked> all;
  Asked &runs = ask(admission, all, "a"), &waits = ask(admission, all, "a");
  admission.drain();
  EXPECT_EQ(waits.answer.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(waits.answer.status().GetPayload(kRetryInfo));
  EXPECT_TRUE(runs.runs());
  EXPECT_EQ(ask(admission, all, "b").answer.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(admission.admit_upload("b").status().code(), absl::StatusCode::kUnavailable);
}

TEST(Admission, AllTicketsComeBackWhateverHappensToThem) {
  AdmissionLimits limits = roomy();
  limits.meshes = {3, 2};
  limits.queued_meshes = {8, 4};
  Admission admission(limits);
  std::atomic<int> answered{0}, left{0};
  {
    std::vector<std::jthread> clients;
    for (int c = 0; c < 4; ++c) {
      clients.emplace_back([&, client = std::string(1, static_cast<char>('a' + c))] {
        for (int i = 0; i < 2000; ++i) {
          const auto place = admission.queue_mesh(
              client, kNever, [&](const absl::StatusOr<Ticket>&) { ++answered; });
          if (i % 3 == 0 && admission.leave(place)) ++left;
          const auto call = admission.admit_call(client),
                     upload = admission.admit_upload(client);
        }
      });
    }
  }
  EXPECT_EQ(answered + left, 4 * 2000);
  EXPECT_EQ(admission.running_meshes(), 0U);
  EXPECT_EQ(admission.queued_meshes(), 0U);
}

}  // namespace
}  // namespace tet
