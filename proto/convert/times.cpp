#include "proto/convert/times.h"

#include <algorithm>

#include <absl/strings/str_cat.h>
#include <google/protobuf/util/time_util.h>

#include "proto/convert/status.h"

namespace tet {

namespace {

using google::protobuf::util::TimeUtil;
constexpr std::int64_t kFirstSecond = TimeUtil::kTimestampMinSeconds;
constexpr std::int64_t kLastSecond = TimeUtil::kTimestampMaxSeconds;
constexpr std::int64_t kLongestSeconds = TimeUtil::kDurationMaxSeconds;
constexpr std::int32_t kNanos = 1'000'000'000;  ///< of a second

template <class Message>
std::string value_of(const Message& message) {
  return absl::StrCat(message.seconds(), " s and ", message.nanos(), " ns");
}

bool is_valid(const google::protobuf::Timestamp& time) {
  return time.seconds() >= kFirstSecond && time.seconds() <= kLastSecond && time.nanos() >= 0 &&
         time.nanos() < kNanos;
}

bool is_valid(const google::protobuf::Duration& span) {
  const bool agree =
      span.seconds() == 0 || span.nanos() == 0 || (span.seconds() > 0) == (span.nanos() > 0);
  return span.seconds() >= -kLongestSeconds && span.seconds() <= kLongestSeconds && agree &&
         span.nanos() > -kNanos && span.nanos() < kNanos;
}

}  // namespace

absl::Time earliest_time() { return absl::FromUnixSeconds(kFirstSecond); }
absl::Time latest_time() {
  return absl::FromUnixSeconds(kLastSecond) + absl::Nanoseconds(kNanos - 1);
}

absl::StatusOr<absl::Time> parse_time(const std::string& field,
                                      const google::protobuf::Timestamp& time) {
  if (is_valid(time)) {
    return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
  }
  return invalid_field(absl::StrCat(field, " of ", value_of(time),
                                    " is no time: seconds are from ", kFirstSecond, " to ",
                                    kLastSecond, ", nanos from 0 to ", kNanos - 1));
}

absl::StatusOr<absl::Duration> parse_span(const std::string& field,
                                          const google::protobuf::Duration& span) {
  if (is_valid(span)) return absl::Seconds(span.seconds()) + absl::Nanoseconds(span.nanos());
  return invalid_field(absl::StrCat(
      field, " of ", value_of(span), " is no duration: seconds are from ", -kLongestSeconds,
      " to ", kLongestSeconds, ", nanos of less than a second and of the same sign"));
}

google::protobuf::Timestamp to_proto(absl::Time time) {
  const absl::Time bounded = std::clamp(time, earliest_time(), latest_time());
  google::protobuf::Timestamp message;
  message.set_seconds(absl::ToUnixSeconds(bounded));
  message.set_nanos(static_cast<std::int32_t>(
      absl::ToInt64Nanoseconds(bounded - absl::FromUnixSeconds(message.seconds()))));
  return message;
}

google::protobuf::Duration to_proto(absl::Duration span) {
  const absl::Duration longest = absl::Seconds(kLongestSeconds);
  absl::Duration rest = std::clamp(span, -longest, longest);
  google::protobuf::Duration message;
  message.set_seconds(absl::IDivDuration(rest, absl::Seconds(1), &rest));
  message.set_nanos(static_cast<std::int32_t>(absl::ToInt64Nanoseconds(rest)));
  return message;
}

google::protobuf::Timestamp within_range(const google::protobuf::Timestamp& time) {
  return to_proto(absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos()));
}

google::protobuf::Duration within_range(const google::protobuf::Duration& span) {
  return to_proto(absl::Seconds(span.seconds()) + absl::Nanoseconds(span.nanos()));
}

std::string text_of(const google::protobuf::Timestamp& time) {
  return TimeUtil::ToString(within_range(time));
}

}  // namespace tet
