// Times and spans as protobuf has them: checked where they come in, bounded where they go out.
//
// google.protobuf's own functions for these end the process where a value is out of range, so
// that nothing else may call them with what others sent or stored.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>
#include <absl/time/time.h>
#include <google/protobuf/duration.pb.h>
#include <google/protobuf/timestamp.pb.h>

namespace tet {

/// What the wire can say: from the beginning of year 1 to the end of year 9999.
absl::Time earliest_time();
absl::Time latest_time();

/// `field` is its name in the message. Errors: kInvalidArgument (INVALID_FIELD) with the value
/// and what it may be: years 1 to 9999, and nanos of less than a second.
absl::StatusOr<absl::Time> parse_time(const std::string& field,
                                      const google::protobuf::Timestamp& time);
/// Does the same for a span: at most 10,000 years, nanos of less than a second and of the same
/// sign.
absl::StatusOr<absl::Duration> parse_span(const std::string& field,
                                          const google::protobuf::Duration& span);

/// What is beyond the wire's range becomes its nearest end.
google::protobuf::Timestamp to_proto(absl::Time time);
google::protobuf::Duration to_proto(absl::Duration span);

/// A message of another's, brought into the wire's range the same way; for what was not
/// checked.
google::protobuf::Timestamp within_range(const google::protobuf::Timestamp& time);
google::protobuf::Duration within_range(const google::protobuf::Duration& span);

/// 2026-01-31T18:00:00Z, with as many digits of a second as there are.
std::string text_of(const google::protobuf::Timestamp& time);

}  // namespace tet
