// Who may call: bearer tokens, and what a client's certificate says.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>
#include <grpcpp/server_context.h>

#include "server/rpc/token_file.h"
#include "server/rpc/watched_file.h"

namespace tet {

/// Who makes a call.
struct Caller {
  std::string name;   ///< the token's, or name_of_peer where there are no tokens
  std::string space;  ///< the namespace whose grids it may see
};

/// The subject of the client's certificate (RFC 2253), else the host it calls from.
std::string name_of_peer(const grpc::ServerContextBase& context);

/// What a method needs; nullopt where any token will do. A method that is not known here is
/// nobody's.
absl::StatusOr<std::optional<Scope>> scope_of(std::string_view method);

/// Checks calls against the file of tokens, which is read again when it changed; a file that
/// cannot be used leaves the old tokens in force, and the log says why. Thread-safe.
class Access {
 public:
  /// An empty path lets everyone do everything.
  /// Errors: those of read_token_file.
  static absl::StatusOr<std::unique_ptr<Access>> open(const std::string& token_file);

  /// Errors: kUnauthenticated (TOKEN_MISSING, TOKEN_UNKNOWN, TOKEN_EXPIRED), kPermissionDenied
  /// (SCOPE_MISSING). Messages quote none of what the caller sent.
  absl::StatusOr<Caller> admit(const grpc::ServerContextBase& context, std::string_view method);

  bool needs_token() const noexcept { return !path_.empty(); }
  /// Looks for a newer file, and whether the tokens in force are old ones, as it cannot be
  /// used.
  bool keeps_old();

 private:
  explicit Access(const std::string& path) : path_(path), watch_({path}) {}
  void reload();
  absl::StatusOr<Token> find(std::string_view bearer);

  const std::string path_;
  std::mutex mutex_;
  FileWatch watch_;
  std::vector<Token> tokens_;
  bool keeps_old_ = false;
};

}  // namespace tet
