// How a call went: a status, or a value in place of one.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "tetstream/export.h"

namespace tetstream {

/// The codes of gRPC, with its numbers.
enum class StatusCode : std::uint8_t {
  kOk = 0,
  kCancelled = 1,  ///< by the caller's stop token, or by a callback that said so
  kUnknown = 2,
  kInvalidArgument = 3,   ///< a field of the request, a file that is not what its name says
  kDeadlineExceeded = 4,  ///< the options' deadline passed
  kNotFound = 5,          ///< a file, a grid, a stored volume
  kAlreadyExists = 6,
  kPermissionDenied = 7,    ///< a file, or a server that knows the caller and refuses
  kResourceExhausted = 8,   ///< over a limit: the message has the value and the limit
  kFailedPrecondition = 9,  ///< no surface at this iso value, an inside without an end
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,
  kInternal = 13,         ///< a fault of this library or of the server
  kUnavailable = 14,      ///< the server cannot be reached, after all attempts
  kDataLoss = 15,         ///< the server's bytes are not what they should be
  kUnauthenticated = 16,  ///< the server does not know the token
};

/// What a failure tells beside its message, as far as it does.
struct FailureDetails {
  /// The request's field that is wrong, by its path in the protocol's message.
  std::string field = {};
  /// What is over a limit, by how much, and the limit.
  std::string what = {};
  std::optional<std::uint64_t> value = {}, limit = {};
  std::string request_id = {};  ///< of the call in the server's log
};

/// Whether a call succeeded, and why it did not. A message says what was wrong, with the value
/// and the limit.
class [[nodiscard]] TETSTREAM_API Status {
 public:
  /// Success.
  Status() = default;
  Status(StatusCode code, std::string message, std::string reason = {});

  bool ok() const noexcept { return code_ == StatusCode::kOk; }
  StatusCode code() const noexcept { return code_; }
  const std::string& message() const noexcept { return message_; }
  /// For programs: a word in capitals as docs/errors.md lists them, such as GRID_NOT_FOUND;
  /// often empty where no server took part.
  const std::string& reason() const noexcept { return reason_; }

  const FailureDetails& details() const noexcept { return details_; }
  Status with_details(FailureDetails details) &&;

  /// The code's name and the message.
  std::string to_string() const;
  /// Throws an Error unless this is a success.
  void or_throw() const;

 private:
  StatusCode code_ = StatusCode::kOk;
  std::string message_, reason_;
  FailureDetails details_;
};

/// What `value` and `or_throw` throw; nothing else in this library throws by intention.
class TETSTREAM_API Error : public std::runtime_error {
 public:
  explicit Error(Status status);
  ~Error() override;
  const Status& status() const noexcept { return status_; }

 private:
  Status status_;
};

/// A value, or why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  /// `status` is a failure.
  Result(Status status) : status_(std::move(status)) {}

  bool ok() const noexcept { return value_.has_value(); }
  explicit operator bool() const noexcept { return ok(); }
  const Status& status() const noexcept { return status_; }

  /// The value. Throws an Error where there is none.
  T& value() & { return status_.or_throw(), *value_; }
  const T& value() const& { return status_.or_throw(), *value_; }
  T&& value() && { return status_.or_throw(), *std::move(value_); }

  /// The value, which must be there.
  T& operator*() & noexcept { return *value_; }
  const T& operator*() const& noexcept { return *value_; }
  T&& operator*() && noexcept { return *std::move(value_); }
  T* operator->() noexcept { return &*value_; }
  const T* operator->() const noexcept { return &*value_; }

 private:
  Status status_;
  std::optional<T> value_;
};

}  // namespace tetstream
