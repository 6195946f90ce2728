// SHA-256: how grid files and meshes are named.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace tet {

/// A digest under construction. Not thread-safe.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(std::span<const std::byte> bytes) noexcept;
  void add(std::string_view text) noexcept { add(std::as_bytes(std::span(text))); }

  /// 64 lower-case hexadecimal digits of what was added; nothing may be added afterwards.
  std::string finish_hex() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 64 lower-case hexadecimal digits.
bool is_sha256_hex(std::string_view text) noexcept;

/// A stored file's name: `grids/{sha256}`.
std::string name_of_grid(std::string_view digest);

/// The digest within such a name; empty for text of another shape.
std::string_view digest_of_name(std::string_view name) noexcept;

}  // namespace tet
