// Room on a disk that is kept for the moment when there is none.
#pragma once

#include <cstdint>
#include <filesystem>

namespace tet {

/// A file beside a database that takes up disk. Where the disk is full it is removed, and what
/// makes room (ending and forgetting jobs) can be written. Processes share it. Thread-safe.
class Ballast {
 public:
  Ballast(std::filesystem::path path, std::uint64_t bytes)
      : path_(std::move(path)), bytes_(bytes) {}

  /// False if there was none.
  bool drop() const;
  /// Makes it whole unless it is, if as much stays free as it takes.
  void keep() const;
  /// Takes what is free right now, but for a little: after room was made and used, before
  /// others take it.
  void retake() const;

 private:
  void make(std::uint64_t bytes) const;

  const std::filesystem::path path_;
  const std::uint64_t bytes_;
};

}  // namespace tet
