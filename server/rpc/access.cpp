#include "server/rpc/access.h"

#include <algorithm>

#include <absl/strings/match.h>
#include <absl/strings/str_format.h>
#include <absl/time/clock.h>
#include <openssl/crypto.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/ops/logging.h"
#include "server/rpc/default_namespace.h"
#include "server/rpc/forwarded.h"

namespace tet {

namespace {

struct MethodScope {
  std::string_view method;
  std::optional<Scope> scope;
};

const MethodScope kMethodScopes[] = {{"FindMissingGrids", Scope::kGridsRead},
                                     {"GetUploadStatus", Scope::kGridsRead},
                                     {"ListGrids", Scope::kGridsRead},
                                     {"GetGridInfo", Scope::kGridsRead},
                                     {"UploadGrid", Scope::kGridsWrite},
                                     {"EstimateMesh", Scope::kMesh},
                                     {"StreamMesh", Scope::kMesh},
                                     {"RemeshSession", Scope::kMesh},
                                     {"SamplePoints", Scope::kMesh},
                                     {"GetCapabilities", std::nullopt},
                                     {"CreateJob", Scope::kJobsWrite},
                                     {"GetJob", Scope::kJobsRead},
                                     {"ListJobs", Scope::kJobsRead},
                                     {"WatchJobs", Scope::kJobsRead},
                                     {"WaitJob", Scope::kJobsRead},
                                     {"CancelJob", Scope::kJobsWrite},
                                     {"RetryJob", Scope::kJobsWrite},
                                     {"DeleteJob", Scope::kJobsWrite},
                                     {"ListDeadShards", Scope::kJobsRead},
                                     {"ReadJobResult", Scope::kJobsRead},
                                     {"ListWorkers", Scope::kWorkersRead}};

absl::Status unauthenticated(const char* message, const char* reason) {
  return with_reason(absl::UnauthenticatedError(message), reason);
}

/// What follows "Bearer " in the only authorization; empty, and nobody's, where it is
/// malformed.
std::optional<std::string> bearer_of(const grpc::ServerContextBase& context) {
  constexpr absl::string_view kScheme = "bearer ";
  const auto [first, last] = context.client_metadata().equal_range("authorization");
  if (first == last) return std::nullopt;
  const absl::string_view value(first->second.data(), first->second.size());
  if (std::next(first) != last || !absl::StartsWithIgnoreCase(value, kScheme)) return "";
  return std::string(value.substr(kScheme.size()));
}

/// "ipv4:10.0.0.7:51234" is of "10.0.0.7". All who come over a socket file are one: the path
/// that such a peer may have bound its own end to is of its choice. A peer of another form is
/// its own name.
std::string host_of(const std::string& peer) {
  if (absl::StartsWith(peer, "unix")) return "unix:";
  const std::size_t scheme = peer.find(':');
  const std::size_t port = peer.rfind(':');
  if (!absl::StartsWith(peer, "ipv") || port == scheme) return peer;
  return peer.substr(scheme + 1, port - scheme - 1);
}

}  // namespace

std::string name_of_peer(const grpc::ServerContextBase& context) {
  const ForwardedPeer peer = peer_of(context);
  return peer.subject.empty() ? host_of(peer.address) : peer.subject;
}

absl::StatusOr<std::optional<Scope>> scope_of(std::string_view method) {
  const auto* found = std::find_if(std::begin(kMethodScopes), std::end(kMethodScopes),
                                   [&](const MethodScope& m) { return m.method == method; });
  if (found != std::end(kMethodScopes)) return found->scope;
  return absl::InternalError(absl::StrFormat("nobody may call %s", method));
}

absl::StatusOr<std::unique_ptr<Access>> Access::open(const std::string& token_file) {
  std::unique_ptr<Access> access(new Access(token_file));
  if (token_file.empty()) return access;
  access->watch_.changed();
  auto tokens = read_token_file(token_file);
  if (!tokens.ok()) return tokens.status();
  access->tokens_ = *std::move(tokens);
  return access;
}

absl::StatusOr<Caller> Access::admit(const grpc::ServerContextBase& context,
                                     std::string_view method) {
  if (!needs_token()) return Caller{name_of_peer(context), std::string(kDefaultSpace)};
  const auto bearer = bearer_of(context);
  if (!bearer) {
    return unauthenticated("no `authorization: Bearer TOKEN` came with the call",
                           "TOKEN_MISSING");
  }
  const absl::StatusOr<Token> token = find(*bearer);
  if (!token.ok()) return token.status();
  const auto scope = scope_of(method);
  if (!scope.ok()) return scope.status();
  if (*scope && !token->allows(**scope)) {
    return with_reason(absl::PermissionDeniedError(absl::StrFormat(
                           "%s needs the scope %s, which token %s does not have", method,
                           name_of(**scope), token->name)),
                       "SCOPE_MISSING");
  }
  return Caller{token->name, token->space};
}

/// Every digest is compared, and all of each: how long it takes tells nothing.
absl::StatusOr<Token> Access::find(std::string_view bearer) {
  Sha256 sha256;
  sha256.add(bearer);
  const std::string digest = sha256.finish_hex();
  const std::lock_guard lock(mutex_);
  reload();
  const Token* found = nullptr;
  for (const Token& token : tokens_) {
    if (CRYPTO_memcmp(token.sha256.data(), digest.data(), digest.size()) == 0) found = &token;
  }
  if (found == nullptr) return unauthenticated("the token is not known", "TOKEN_UNKNOWN");
  if (found->expires && *found->expires <= absl::Now()) {
    return unauthenticated("the token has expired", "TOKEN_EXPIRED");
  }
  return *found;
}

bool Access::keeps_old() {
  const std::lock_guard lock(mutex_);
  if (needs_token()) reload();
  return keeps_old_;
}

void Access::reload() {
  if (!watch_.changed()) return;
  auto tokens = read_token_file(path_);
  keeps_old_ = !tokens.ok();
  if (tokens.ok()) {
    tokens_ = *std::move(tokens);
    log_event(spdlog::level::info, "tokens_reloaded", {{"tokens", tokens_.size()}});
  } else {
    log_event(spdlog::level::err, "tokens_kept",
              {{"message", std::string(tokens.status().message())}});
  }
}

}  // namespace tet
