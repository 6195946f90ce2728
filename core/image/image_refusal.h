// How a reader of images says no.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <absl/status/status.h>

namespace tet {

/// Thrown from within a reader, and turned into its status where it began: a parser that tests
/// every one of its reads by hand forgets one. Never leaves core/image.
class ImageRefusal {
 public:
  explicit ImageRefusal(absl::Status status) : status_(std::move(status)) {}
  const absl::Status& status() const noexcept { return status_; }

 private:
  absl::Status status_;
};

/// The file breaks its format. kInvalidArgument.
[[noreturn]] void refuse_image(const std::string& why);

/// The file is fine, and what it holds cannot be meshed. kFailedPrecondition: says what to do.
[[noreturn]] void refuse_contents(const std::string& why);

/// Text of the file as a message may have it: in quotes, printable, at most 60 bytes of it.
std::string quoted_text(std::string_view text);

}  // namespace tet
