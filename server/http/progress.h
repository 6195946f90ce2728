// How well a connection gets on, as others may need its place or its room.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace tet {

/// The bytes that a connection moves, in strides: who sends or takes a byte now and then gets
/// nowhere, however often that is. Bytes that wait in our socket are not moved yet.
class Progress {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kStride = 64 << 10;

  /// Begins a stride with no byte moved: from now on the other side is waited for.
  void begin(Clock::time_point now) noexcept {
    in_stride_ = 0;
    since_ = now;
  }
  /// Counts bytes that came, or that the other side took. The next stride begins where they are
  /// as many as one has.
  void moved(std::size_t bytes, Clock::time_point now) noexcept {
    in_stride_ += bytes;
    if (in_stride_ < kStride) return;
    in_stride_ %= kStride;
    since_ = now;
  }
  /// Counts bytes that the socket took, for the other side to take.
  void gave(std::size_t bytes) noexcept { in_socket_ += bytes; }
  /// Whether the other side may have taken some of them since the last `looked`.
  bool is_taking() const noexcept { return in_socket_ > 0; }
  /// Counts what the other side took since the last time, as so many bytes are not
  /// acknowledged yet. TLS makes those more than we gave.
  void looked(std::size_t unacknowledged, Clock::time_point now) noexcept {
    const std::size_t left = std::min(in_socket_, unacknowledged);
    moved(in_socket_ - left, now);
    in_socket_ = left;
  }

  /// When the present stride began.
  Clock::time_point since() const noexcept { return since_; }

 private:
  Clock::time_point since_ = Clock::now();
  std::size_t in_stride_ = 0;  ///< bytes of the present stride
  std::size_t in_socket_ = 0;  ///< bytes that were given, and not taken when we last looked
};

}  // namespace tet
