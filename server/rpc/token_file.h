// The file of tokens: who may call, what for, and in which namespace.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>
#include <absl/time/time.h>

namespace tet {

/// What a token may be used for.
enum class Scope { kGridsRead, kGridsWrite, kMesh, kJobsRead, kJobsWrite, kWorkersRead };
inline constexpr std::array kScopes = {Scope::kGridsRead, Scope::kGridsWrite,
                                       Scope::kMesh,      Scope::kJobsRead,
                                       Scope::kJobsWrite, Scope::kWorkersRead};

/// "grids.read", "grids.write", "mesh", "jobs.read", "jobs.write" or "workers.read", as the
/// file and error messages have it.
std::string_view name_of(Scope scope) noexcept;

/// One entry. The token itself is nowhere: only its digest is.
struct Token {
  std::string name;    ///< who it was given to, for logs and limits
  std::string sha256;  ///< of the token's text, 64 hexadecimal digits
  std::vector<Scope> scopes;
  std::string space;  ///< the namespace its grids are in
  std::optional<absl::Time> expires;

  bool allows(Scope scope) const noexcept;
};

/// Reads a TOML file of [[token]] tables.
/// Errors: kInvalidArgument (not readable, readable by others, not TOML, an entry that is wrong
/// or has another's name or digest; the message has the line and quotes nothing that could be a
/// secret).
absl::StatusOr<std::vector<Token>> read_token_file(const std::string& path);

struct NewToken {
  std::string text;   ///< to be given to its owner
  std::string entry;  ///< to be added to the file
};

/// A fresh token of 256 random bits. Errors: kInvalidArgument (the name), kInternal (no
/// randomness).
absl::StatusOr<NewToken> make_token(const std::string& name);

}  // namespace tet
