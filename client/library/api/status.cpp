#include "tetstream/status.h"

#include <array>
#include <cstddef>

namespace tetstream {
namespace {

constexpr std::array kCodeNames{"OK",
                                "CANCELLED",
                                "UNKNOWN",
                                "INVALID_ARGUMENT",
                                "DEADLINE_EXCEEDED",
                                "NOT_FOUND",
                                "ALREADY_EXISTS",
                                "PERMISSION_DENIED",
                                "RESOURCE_EXHAUSTED",
                                "FAILED_PRECONDITION",
                                "ABORTED",
                                "OUT_OF_RANGE",
                                "UNIMPLEMENTED",
                                "INTERNAL",
                                "UNAVAILABLE",
                                "DATA_LOSS",
                                "UNAUTHENTICATED"};

}  // namespace

Status::Status(StatusCode code, std::string message, std::string reason)
    : code_(code), message_(std::move(message)), reason_(std::move(reason)) {}

Status Status::with_details(FailureDetails details) && {
  details_ = std::move(details);
  return std::move(*this);
}

std::string Status::to_string() const {
  const auto code = static_cast<std::size_t>(code_);
  const std::string name = code < kCodeNames.size() ? kCodeNames[code] : "UNKNOWN";
  return message_.empty() ? name : name + ": " + message_;
}

void Status::or_throw() const {
  if (!ok()) throw Error(*this);
}

Error::Error(Status status)
    : std::runtime_error(status.to_string()), status_(std::move(status)) {}
Error::~Error() = default;

}  // namespace tetstream
