// The lines of a header in text.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <absl/strings/string_view.h>

namespace tet {

/// Gives one line after the other, without its end ("\n" or "\r\n").
class HeaderLines {
 public:
  explicit HeaderLines(std::span<const std::byte> head)
      : text_(reinterpret_cast<const char*>(head.data()), head.size()) {}

  /// Returns nothing where no further line has an end.
  std::optional<std::string_view> next();

  /// Where the next line begins.
  std::size_t position() const noexcept { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// `text` without white space at its ends.
std::string_view trimmed(std::string_view text);

/// The parts of `text` between separators, empty ones too; the last one has the rest.
std::vector<std::string_view> split_text(std::string_view text,
                                         char separator,
                                         std::size_t most);

/// Abseil of Debian 12 has a string_view of its own.
inline absl::string_view as_absl(std::string_view text) { return {text.data(), text.size()}; }

/// Headers of text may be this long.
inline constexpr std::size_t kTextHeaderBytes = std::size_t{64} << 10;

}  // namespace tet
