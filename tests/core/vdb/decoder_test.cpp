#include "core/vdb/decoder/decoder.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <future>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "tests/core/vdb/decode_test_files.h"
#include "tests/core/vdb/hanging_decoder.h"

namespace tet {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

class DecoderTest : public test::DecodeTest {
 protected:
  absl::Status decode_with(Decoder& decoder) const {
    const auto checked = check_request(request(), test::kGenerousEnd);
    if (!checked.ok()) return checked.status();
    return decoder.decode(checked->order, checked->file.number(), {test::kGenerousEnd, nullptr})
        .status();
  }
  void expect_crash(const std::string& deed, const std::string& why) {
    expect_failure(deed, "DECODER_CRASHED", why);
  }
  void expect_failure(const std::string& deed,
                      const std::string& name,
                      const std::string& why) {
    SCOPED_TRACE(deed);
    expect_told(outcome(deed), name, why);
  }
  static void expect_told(const absl::Status& status,
                          const std::string& name,
                          const std::string& why) {
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_EQ(failure_name(status), name) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
    EXPECT_THAT(std::string(status.message()), HasSubstr("'grids/abc'"));
  }
};

TEST_F(DecoderTest, HandsBackWhatThisProcessWouldRead) {
  const absl::StatusOr<Volume> there =
      volume_of(decode_once(request(), test::patient_settings(), nullptr), request());
  const absl::StatusOr<Volume> here = load_volume(path_, "");
  ASSERT_TRUE(there.ok()) << there.status();
  EXPECT_EQ(there->name, here->name);
  EXPECT_EQ(there->bricks, here->bricks);
  EXPECT_EQ(there->values, here->values);
  EXPECT_EQ(there->kind, here->kind);
}

TEST_F(DecoderTest, ListsWhatThisProcessWouldList) {
  FileRequest list = request();
  list.task = DecodeTask::kGridList;
  const auto there = grid_list_of(decode_once(list, test::patient_settings(), nullptr), list);
  ASSERT_TRUE(there.ok()) << there.status();
  ASSERT_EQ(there->size(), 1U);
  EXPECT_EQ(there->front().name, "sphere");
  EXPECT_EQ(there->front().active_voxels, list_grids(path_)->front().active_voxels);
}

TEST_F(DecoderTest, HasTimeToListWhatHasToBeUnpackedForThat) {
  // By bgzip, whose last member has nothing in it: 6 GB, as far as anybody knows.
  test::write_bytes(path_, std::string("\x1f\x8b\x08\x04", 4));
  std::filesystem::resize_file(path_, 100'000'000);
  FileRequest list = request();
  list.task = DecodeTask::kGridList;
  const auto checked = check_request(list, std::chrono::hours(1));
  ASSERT_TRUE(checked.ok()) << checked.status();
  EXPECT_GE(checked->order.limits.cpu_seconds, 100U);
  EXPECT_LT(checked->order.limits.working_bytes, 100'000'000U);  // it is not kept
}

TEST_F(DecoderTest, HandsBackEachComponentOfAField) {
  test::write_fixture("vec3", 0.1, path_);
  FileRequest field = request("vec3");
  field.task = DecodeTask::kField;
  for (field.component = 0; field.component < 3; ++field.component) {
    const auto there = volume_of(decode_once(field, test::patient_settings(), nullptr), field);
    ASSERT_TRUE(there.ok()) << there.status();
    EXPECT_EQ(there->kind, VolumeKind::kVectorField);
    EXPECT_EQ(there->values, load_field(path_, "vec3", field.component)->values);
  }
  EXPECT_TRUE(absl::IsInvalidArgument(
      volume_of(decode_once(field, test::patient_settings(), nullptr), field).status()));
}

TEST_F(DecoderTest, IsNotBelievedToHaveReadAFieldForASurface) {
  FileRequest field = request();
  field.task = DecodeTask::kField;
  for (const auto& [asked, read] : {std::pair(field, request()), std::pair(request(), field)}) {
    const absl::Status status =
        volume_of(decode_once(read, test::patient_settings(), nullptr), asked).status();
    EXPECT_EQ(failure_name(status), "DECODER_RESULT") << status;
  }
}

TEST_F(DecoderTest, PassesOnWhatTheReaderSaysOfTheFile) {
  const FileRequest other = request("other");
  const absl::Status status =
      volume_of(decode_once(other, test::patient_settings(), nullptr), other).status();
  EXPECT_TRUE(absl::IsNotFound(status)) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("no grid 'other'"));
  EXPECT_THAT(std::string(status.message()), Not(HasSubstr(path_)));
}

TEST_F(DecoderTest, CostsOnlyItsRequestWhenItEndsBadly) {
  expect_crash("segfault", "signal 11");
  expect_crash("exit", "ended with 5");
  DecoderSettings impatient = test::patient_settings(hostile("close"));
  impatient.program.patience.last_moment = 100ms;  // for then it has to be killed
  expect_told(outcome(impatient), "DECODER_CRASHED", "did not answer");
}

TEST_F(DecoderTest, IsNotBelievedWhatItSays) {
  expect_crash("nonsense", "ended with 6 and no answer");
  expect_crash("lies", "ended with 6 and no answer");
  const absl::Status loud = outcome("shouts");
  EXPECT_TRUE(absl::IsInvalidArgument(loud));
  EXPECT_EQ(failure_name(loud), "");
  EXPECT_EQ(loud.message().size(), 500U);
  EXPECT_THAT(std::string(loud.message()), testing::StartsWith("?[2J?AAA"));
}

TEST_F(DecoderTest, IsNotBelievedWhatItHandsBack) {
  expect_failure("unsealed", "DECODER_RESULT", "not sealed");
  expect_failure("empty", "DECODER_RESULT", "0 bytes");
  expect_failure("short", "DECODER_RESULT", "hold no header");
  expect_failure("holes", "DECODER_RESULT", "holes");
  expect_failure("corrupt", "DECODER_RESULT", "not valid");
}

TEST_F(DecoderTest, IsUnavailableWhenNoProgramStarts) {
  for (const char* deed : {"stillborn", "no/such/program"}) {
    const DecoderSettings settings =
        test::patient_settings(deed == std::string("stillborn") ? hostile(deed) : deed);
    const absl::Status status = decode_once(request(), settings, nullptr).status();
    EXPECT_TRUE(absl::IsUnavailable(status)) << status;
    EXPECT_EQ(failure_name(status), "DECODER_UNAVAILABLE");
  }
}

TEST_F(DecoderTest, IsKilledWhenItTakesTooLong) {
  DecoderSettings settings = test::patient_settings(hostile("hang"));
  settings.max_time = 200ms;
  const absl::Status status = decode_once(request(), settings, nullptr).status();
  EXPECT_EQ(failure_name(status), "DECODER_TIMEOUT") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("longer than 0.2 s"));
}

TEST_F(DecoderTest, IsKilledAtOnceWhenNobodyWantsItsResult) {
  const DecoderSettings settings = test::patient_settings(hostile("hang"));
  std::atomic<bool> cancelled{false};
  std::atomic<int> told{0};
  auto decoding = std::async(std::launch::async, [&] {
    return decode_once(request(), settings,
                       [&] {
                         told += cancelled ? 1 : 0;
                         return cancelled.load();
                       })
        .status();
  });
  EXPECT_NE(test::hanging_decoder(settings.program.path), 0);
  cancelled = true;
  EXPECT_TRUE(absl::IsCancelled(decoding.get()));
  EXPECT_LE(told, 2) << "who was told so does not ask again and again";
}

TEST_F(DecoderTest, IsNotAskedForAFileThatIsWalkedOverForNobody) {
  // Nobody gets as far as to miss it.
  const DecoderSettings settings = test::patient_settings(directory_.file("no program"));
  int asked = 0;
  const absl::Status status =
      decode_once(request(), settings, [&] { return ++asked > 0; }).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << status;
  EXPECT_EQ(asked, 1);
}

TEST_F(DecoderTest, IsEndedBeforeAnyOtherWhereMemoryIsShort) {
  absl::StatusOr<Decoder> decoder = Decoder::start(test::patient_program());
  ASSERT_TRUE(decoder.ok()) << decoder.status();
  ASSERT_EQ(decoder->wait_until_ready(nullptr), absl::OkStatus());
  absl::StatusOr<Decoder> copy = decoder->copy(nullptr);
  ASSERT_TRUE(copy.ok()) << copy.status();
  ASSERT_EQ(copy->wait_until_ready(nullptr), absl::OkStatus());
  for (const pid_t pid : {decoder->pid(), copy->pid()}) {
    int told = 0;
    std::ifstream("/proc/" + std::to_string(pid) + "/oom_score_adj") >> told;
    EXPECT_EQ(told, 1000);
  }
}

TEST_F(DecoderTest, CopiesItselfForOneFileAfterAnother) {
  absl::StatusOr<Decoder> original = Decoder::start(test::patient_program());
  ASSERT_TRUE(original.ok()) << original.status();
  ASSERT_EQ(original->wait_until_ready(nullptr), absl::OkStatus());
  for (int i = 0; i < 3; ++i) {
    absl::StatusOr<Decoder> copy = original->copy(nullptr);
    ASSERT_TRUE(copy.ok()) << copy.status();
    EXPECT_NE(copy->pid(), original->pid());
    EXPECT_EQ(copy->wait_until_ready(nullptr), absl::OkStatus());
    EXPECT_TRUE(decode_with(*copy).ok());
    EXPECT_EQ(::kill(original->pid(), 0), 0);
  }
  EXPECT_TRUE(decode_with(*original).ok());
  EXPECT_TRUE(absl::IsUnavailable(original->copy(nullptr).status()));
}

// The sandbox killed one that closed its files when it had answered.
TEST_F(DecoderTest, EndsByItselfOnceItHasAnswered) {
  absl::StatusOr<Decoder> decoder = Decoder::start(test::patient_program());
  ASSERT_TRUE(decoder.ok()) << decoder.status();
  ASSERT_EQ(decoder->wait_until_ready(nullptr), absl::OkStatus());
  ASSERT_EQ(decode_with(*decoder), absl::OkStatus());
  siginfo_t how{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(decoder->pid()), &how, WEXITED | WNOWAIT), 0);
  EXPECT_EQ(how.si_code, CLD_EXITED) << "signal " << how.si_status;
}

TEST_F(DecoderTest, LeavesNoProcessBehind) {
  pid_t pid = 0;
  {
    const absl::StatusOr<Decoder> decoder =
        Decoder::start(test::patient_program(hostile("asleep")));
    ASSERT_TRUE(decoder.ok()) << decoder.status();
    pid = decoder->pid();
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_EQ(::kill(pid, 0), -1);  // not even as a zombie
}

// It is asked to copy itself, and given up, or ends, when the copy is there and before it is
// told of.
TEST_F(DecoderTest, LeavesNoCopyBehindThatNobodyWasToldOf) {
  for (const char* const deed : {"silent", "gone"}) {
    const std::string program = hostile(deed);
    absl::StatusOr<Decoder> original = Decoder::start(test::patient_program(program));
    ASSERT_TRUE(original.ok()) << original.status();
    ASSERT_EQ(original->wait_until_ready(nullptr), absl::OkStatus());
    const bool cancels = std::string_view(deed) == "silent";
    const absl::Status status =
        original->copy([&] { return cancels && test::hangs(program); }).status();
    EXPECT_TRUE(cancels ? absl::IsCancelled(status) : absl::IsUnavailable(status)) << status;
    const pid_t copy = test::hanging_decoder(program);
    ASSERT_NE(copy, 0);
    for (const pid_t pid : {copy, original->pid()}) EXPECT_EQ(::kill(pid, 0), -1) << deed;
    EXPECT_TRUE(absl::IsUnavailable(original->copy(nullptr).status()));
  }
}

TEST_F(DecoderTest, EndsWithTheThreadThatStartedIt) {
  std::optional<absl::StatusOr<Decoder>> decoder;
  std::thread([&] {
    absl::StatusOr<Decoder> original = Decoder::start(test::patient_program());
    EXPECT_EQ(original->wait_until_ready(nullptr), absl::OkStatus());
    decoder.emplace(original->copy(nullptr));
    EXPECT_EQ((*decoder)->wait_until_ready(nullptr), absl::OkStatus());
  }).join();
  // A thread has been joined before its children are told.
  ASSERT_TRUE(test::eventually([&] { return test::has_ended((*decoder)->pid()); }));
  const absl::Status status = decode_with(**decoder);
  EXPECT_FALSE(status.ok());
  EXPECT_NE(failure_name(status), "DECODER_TIMEOUT") << status;
}

}  // namespace
}  // namespace tet
