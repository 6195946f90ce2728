#include "server/rpc/token_file.h"

#include <algorithm>
#include <set>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <openssl/rand.h>
#include <toml++/toml.h>

#include "proto/wire/sha256.h"
#include "server/rpc/watched_file.h"

namespace tet {

namespace {

// Its owner writes it, and a group may read it, as systemd's credentials and Kubernetes'
// secrets have it.
constexpr mode_t kForbidden = 037;
constexpr std::size_t kMaxName = 64;

absl::Status wrong(std::string_view key, std::string_view what) {
  return absl::InvalidArgumentError(absl::StrFormat("%s %s", key, what));
}

/// Names become folders, log fields and the keys of limits.
absl::Status check_name(std::string_view key, std::string_view name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return absl::ascii_islower(static_cast<unsigned char>(c)) ||
           absl::ascii_isdigit(static_cast<unsigned char>(c)) || c == '-' || c == '_';
  });
  if (plain && !name.empty() && name.size() <= kMaxName) return absl::OkStatus();
  return wrong(key, absl::StrCat("is not 1 to ", kMaxName, " of a-z, 0-9, - and _"));
}

absl::Status read_text(const toml::node& node, std::string_view key, std::string& text) {
  if (!node.is_string()) return wrong(key, "is not text");
  text = node.as_string()->get();
  return absl::OkStatus();
}

absl::Status read_digest(const toml::node& node, std::string& digest) {
  if (const auto status = read_text(node, "sha256", digest); !status.ok()) return status;
  if (is_sha256_hex(digest)) return absl::OkStatus();
  return wrong("sha256", "is not 64 lower-case hexadecimal digits");
}

absl::Status read_scopes(const toml::node& node, std::vector<Scope>& scopes) {
  const std::string all = absl::StrJoin(
      kScopes, ", ", [](std::string* out, Scope scope) { *out += name_of(scope); });
  const toml::array* list = node.as_array();
  if (list == nullptr) return wrong("scopes", absl::StrCat("is not a list of ", all));
  for (const toml::node& item : *list) {
    const auto* found = std::find_if(kScopes.begin(), kScopes.end(), [&](Scope scope) {
      return item.value_or(std::string()) == name_of(scope);
    });
    if (found == kScopes.end())
      return wrong("scopes", absl::StrCat("has one that is none of ", all));
    scopes.push_back(*found);
  }
  return absl::OkStatus();
}

absl::Status read_expiry(const toml::node& node, std::optional<absl::Time>& expires) {
  const auto* value = node.as_date_time();
  if (value == nullptr || !value->get().offset) {
    return wrong("expires", "is not a time with its zone, as 2027-01-31T00:00:00Z");
  }
  const toml::date_time& time = value->get();
  const absl::CivilSecond civil(time.date.year, time.date.month, time.date.day, time.time.hour,
                                time.time.minute, time.time.second);
  expires = absl::FromCivil(civil, absl::UTCTimeZone()) - absl::Minutes(time.offset->minutes);
  return absl::OkStatus();
}

absl::Status read_key(std::string_view key, const toml::node& node, Token& token) {
  if (key == "name") return read_text(node, key, token.name);
  if (key == "sha256") return read_digest(node, token.sha256);
  if (key == "scopes") return read_scopes(node, token.scopes);
  if (key == "namespace") return read_text(node, key, token.space);
  if (key == "expires") return read_expiry(node, token.expires);
  return wrong("a key", "is none of name, sha256, scopes, namespace, expires");
}

absl::Status read_token(const toml::table& table, Token& token) {
  for (const auto& [key, node] : table) {
    if (const auto status = read_key(key.str(), node, token); !status.ok()) return status;
  }
  if (const auto status = check_name("name", token.name); !status.ok()) return status;
  if (token.sha256.empty()) return wrong("sha256", "is missing");
  if (token.scopes.empty()) return wrong("scopes", "is missing");
  return check_name("namespace", token.space);
}

absl::StatusOr<std::vector<Token>> read_tokens(const toml::table& file) {
  std::vector<Token> tokens;
  std::set<std::string> taken;
  const toml::array* list = file["token"].as_array();
  if (file.size() != (list == nullptr ? 0U : 1U))
    return wrong("the file", "has more than [[token]]");
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const toml::table* table = list->get(i)->as_table();
    if (table == nullptr) return wrong("token", "is not a table [[token]]");
    Token token;
    absl::Status status = read_token(*table, token);
    if (status.ok() && !taken.insert(token.name).second) status = wrong("name", "is taken");
    if (status.ok() && !taken.insert(token.sha256).second) status = wrong("sha256", "is taken");
    if (!status.ok())
      return absl::InvalidArgumentError(
          absl::StrFormat("%d: %s", table->source().begin.line, status.message()));
    tokens.push_back(std::move(token));
  }
  return tokens;
}

}  // namespace

std::string_view name_of(Scope scope) noexcept {
  switch (scope) {
    case Scope::kGridsRead:
      return "grids.read";
    case Scope::kGridsWrite:
      return "grids.write";
    case Scope::kMesh:
      return "mesh";
    case Scope::kJobsRead:
      return "jobs.read";
    case Scope::kJobsWrite:
      return "jobs.write";
    case Scope::kWorkersRead:
      return "workers.read";
  }
  return "";
}

bool Token::allows(Scope scope) const noexcept {
  return std::find(scopes.begin(), scopes.end(), scope) != scopes.end();
}

absl::StatusOr<std::vector<Token>> read_token_file(const std::string& path) {
  const auto text = read_small_file(path, kForbidden);
  if (!text.ok()) return text.status();
  try {
    auto tokens = read_tokens(toml::parse(*text));
    if (tokens.ok()) return tokens;
    return absl::InvalidArgumentError(absl::StrCat(path, ":", tokens.status().message()));
  } catch (const toml::parse_error& error) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ":", error.source().begin.line, ": not TOML"));
  }
}

absl::StatusOr<NewToken> make_token(const std::string& name) {
  if (const auto status = check_name("the token's name", name); !status.ok()) return status;
  std::string bytes(32, '\0');
  if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), 32) != 1) {
    return absl::InternalError("no random bytes to be had");
  }
  NewToken token;
  token.text = absl::StrCat("tetstream_", absl::WebSafeBase64Escape(bytes));
  Sha256 digest;
  digest.add(token.text);
  token.entry = absl::StrFormat(
      "[[token]]\nname = \"%s\"\nsha256 = \"%s\"\n"
      "scopes = [\"grids.read\", \"grids.write\", \"mesh\", \"jobs.read\", "
      "\"jobs.write\"]\nnamespace = \"%s\"\n",
      name, digest.finish_hex(), name);
  return token;
}

}  // namespace tet
