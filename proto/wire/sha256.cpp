#include "proto/wire/sha256.h"

#include <algorithm>
#include <array>

#include <openssl/evp.h>

namespace tet {

namespace {
constexpr std::string_view kGridPrefix = "grids/";
constexpr std::string_view kHexDigits = "0123456789abcdef";
}  // namespace

struct Sha256::State {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  State() { EVP_DigestInit_ex(context, EVP_sha256(), nullptr); }
  ~State() { EVP_MD_CTX_free(context); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::add(std::span<const std::byte> bytes) noexcept {
  EVP_DigestUpdate(state_->context, bytes.data(), bytes.size());
}

std::string Sha256::finish_hex() noexcept {
  std::array<unsigned char, 32> digest{};
  EVP_DigestFinal_ex(state_->context, digest.data(), nullptr);
  std::string text;
  for (const unsigned char byte : digest) {
    text += kHexDigits[byte >> 4];
    text += kHexDigits[byte & 15];
  }
  return text;
}

bool is_sha256_hex(std::string_view text) noexcept {
  return text.size() == 64 && text.find_first_not_of(kHexDigits) == std::string_view::npos;
}

std::string name_of_grid(std::string_view digest) {
  return std::string(kGridPrefix).append(digest);
}

std::string_view digest_of_name(std::string_view name) noexcept {
  if (!name.starts_with(kGridPrefix)) return {};
  const std::string_view digest = name.substr(kGridPrefix.size());
  return is_sha256_hex(digest) ? digest : std::string_view{};
}

}  // namespace tet
