// TLS for the listening port, from files that may be replaced while it serves.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <absl/status/statusor.h>
#include <absl/time/time.h>
#include <grpc/grpc_security.h>
#include <grpcpp/security/server_credentials.h>
#include <openssl/x509.h>

#include "server/rpc/watched_file.h"

namespace tet {

/// PEM files. Without `client_ca` clients need no certificate.
struct TlsFiles {
  std::string cert;       ///< the server's certificate, and those that lead to its root
  std::string key;        ///< its private key
  std::string client_ca;  ///< who signs clients' certificates
};

/// What they held when they were read and checked.
struct TlsMaterial {
  std::string cert, key, client_ca;
  std::string subject;  ///< of the server's certificate
  absl::Time expires;
};

/// Returns a certificate's subject (RFC 2253).
std::string subject_of(const X509& certificate);

/// Errors: kInvalidArgument (a file that cannot be read or is not what it should be, a key that
/// others may read or that is another certificate's; the message names the file).
absl::StatusOr<TlsMaterial> load_tls(const TlsFiles& files);

/// The port's credentials: TLS 1.2 and later. Files that changed are read again before the next
/// handshake; where they cannot be used the old ones stay, and the log says why. Connections
/// that are open keep what they were opened with. Thread-safe.
class ServerTls {
 public:
  /// Errors: those of load_tls.
  static absl::StatusOr<std::unique_ptr<ServerTls>> open(TlsFiles files);

  /// Returns what the files hold, having looked for newer ones, unless the caller has it; then
  /// `generation` is that of what is returned. It is 0 for a caller that has nothing.
  std::optional<TlsMaterial> newer_than(std::uint64_t& generation);

  /// Looks for newer files, and whether what is in force is old, as they cannot be used.
  bool keeps_old();
  /// When the certificate in force ends.
  absl::Time expires();

  /// The server that uses them ends before `this`.
  std::shared_ptr<grpc::ServerCredentials> credentials();

 private:
  explicit ServerTls(TlsFiles files);
  absl::Status load();
  bool reload();

  using Reload = grpc_ssl_certificate_config_reload_status;
  static Reload fetch(void* self, grpc_ssl_server_certificate_config** config);
  Reload fetch(grpc_ssl_server_certificate_config** config);

  const TlsFiles files_;
  std::mutex mutex_;
  FileWatch watch_;
  TlsMaterial material_;
  std::uint64_t generation_ = 0;  ///< grows with each load
  bool handed_out_ = false, keeps_old_ = false;
};

}  // namespace tet
