// Memory that two processes share: one writes, the other reads, and neither can harm the other.
#pragma once

#include <cstddef>
#include <span>
#include <sys/types.h>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"

namespace tet {

/// Bytes mapped into this process, until it is destroyed.
class Mapping {
 public:
  Mapping() = default;
  Mapping(void* begin, std::size_t size) noexcept : begin_(begin), size_(size) {}
  ~Mapping();
  Mapping(Mapping&& other) noexcept;
  Mapping& operator=(Mapping&& other) noexcept;

  bool is_there() const noexcept { return begin_ != nullptr; }
  std::byte* begin() const noexcept { return static_cast<std::byte*>(begin_); }
  std::size_t size() const noexcept { return size_; }

 private:
  void* begin_ = nullptr;
  std::size_t size_ = 0;
};

/// Who reads what a process makes.
enum class Readers : bool {
  kAny,
  /// Processes of another user than the maker's, without the right to overrule files' rights
  /// (CAP_DAC_OVERRIDE, CAP_FOWNER): not of root.
  kOtherUser,
};

/// Memory that its maker alone writes. Nobody can make it shorter or longer: a reader that may
/// do what it likes cannot change a byte, and cannot have its maker ended by SIGBUS.
///
/// For any readers it is mapped for writing and then sealed: nobody can map it for writing or
/// write to its descriptor any more. So nobody can free its pages, either: they are there for
/// as long as anybody has them. Readers of another user are handed a descriptor that only
/// reads, of a file that only its owner may open: they cannot have it opened for writing, and
/// the maker can free the pages.
class SealedMemory {
 public:
  /// `bytes` of zeros. Errors: kResourceExhausted (no memory, no descriptor), kUnimplemented (a
  /// kernel that does not have these seals).
  static absl::StatusOr<SealedMemory> make(std::size_t bytes, Readers readers = Readers::kAny);

  /// What is handed to the reader.
  const Descriptor& descriptor() const noexcept {
    return reading_.is_open() ? reading_ : writing_;
  }
  std::span<std::byte> bytes() const noexcept { return {mapping_.begin(), mapping_.size()}; }

  /// Whether its pages can be freed while readers have them: for readers of another user, where
  /// the process sees /proc.
  bool can_be_given_up() const noexcept { return reading_.is_open(); }
  /// Frees its pages, where they can be: whoever still reads finds zeros, in pages of its own
  /// account.
  void give_up() const noexcept;

 private:
  Descriptor writing_, reading_;
  Mapping mapping_;
};

/// Another process's sealed memory, to be read. Trusts nothing: what can become shorter, so
/// that reading it would end this process, is refused. Its bytes may change at any time.
class SharedMemory {
 public:
  /// Maps `bytes` of it. Errors: kInvalidArgument (it is shorter, can become so, or is no
  /// memory), kResourceExhausted (no room for it).
  static absl::StatusOr<SharedMemory> map(const Descriptor& descriptor, std::size_t bytes);

  /// Whether its pages are there for as long as this is: its maker cannot give them up.
  bool holds_pages() const noexcept { return holds_pages_; }
  /// Whether it is `bytes` of the memory that this is a descriptor of.
  bool is_of(const Descriptor& descriptor, std::size_t bytes) const noexcept;

  std::span<const std::byte> bytes() const noexcept {
    return {mapping_.begin(), mapping_.size()};
  }

 private:
  Mapping mapping_;
  dev_t device_ = 0;
  ino_t number_ = 0;  ///< there
  bool holds_pages_ = false;
};

}  // namespace tet
