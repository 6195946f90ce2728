// How the walker says no.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <absl/status/status.h>

namespace tet {

/// Thrown from within the walker, and turned into its status where it began: a parser that
/// tests every one of its reads by hand forgets one. Never leaves core/vdb.
class WalkRefusal {
 public:
  explicit WalkRefusal(absl::Status status) : status_(std::move(status)) {}
  const absl::Status& status() const noexcept { return status_; }

 private:
  absl::Status status_;
};

/// The file breaks its format at byte `offset`. kInvalidArgument, at most 300 characters.
[[noreturn]] void refuse_at(std::uint64_t offset, const std::string& why);

/// The file is well-formed so far, and more than is allowed. kResourceExhausted.
[[noreturn]] void refuse_over_limit(const std::string& why);

/// A name from the file, fit to be told: in quotes, escaped, at most 64 characters of it.
std::string quoted_name(const std::string& name);

}  // namespace tet
