// A file descriptor that closes itself.
#pragma once

#include <filesystem>
#include <sys/types.h>
#include <unistd.h>
#include <utility>

namespace tet {

/// Owns an open descriptor, or none. Not thread-safe.
class Descriptor {
 public:
  Descriptor() = default;
  /// Takes over what a system call returned; negative is none.
  explicit Descriptor(int number) noexcept : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    number_ = std::exchange(other.number_, -1);
    return *this;
  }

  bool is_open() const noexcept { return number_ >= 0; }
  int number() const noexcept { return number_; }

  /// False when the system reports a failure, which `errno` then tells; some file systems tell
  /// only here that earlier writes were lost. Linux closes the descriptor in any case, so this
  /// is never tried again.
  bool close() noexcept { return !is_open() || ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_ = -1;
};

/// open(2), tried again when a signal interrupts it. Programs that this process starts do not
/// inherit the descriptor. On failure none is open, and `errno` tells why. `mode` is for files
/// that it makes.
Descriptor open_descriptor(const std::filesystem::path& path,
                           int flags,
                           mode_t mode = 0666) noexcept;

/// openat(2) of a file that there is: as open_descriptor, from `folder` on.
Descriptor open_descriptor_in(const Descriptor& folder,
                              const std::filesystem::path& path,
                              int flags) noexcept;

}  // namespace tet
