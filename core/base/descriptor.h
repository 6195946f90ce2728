// A file descriptor that closes itself.
#pragma once

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
  void close() noexcept {
    if (is_open()) ::close(std::exchange(number_, -1));
  }

 private:
  int number_ = -1;
};

}  // namespace tet
