#include "client/library/channel.h"

#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>

#include "core/base/posix/socket_file.h"
#include "proto/wire/loopback.h"
#include "proto/wire/transport.h"

namespace tet {

namespace {

using Credentials = std::shared_ptr<grpc::ChannelCredentials>;

/// What the system has room for.
constexpr std::size_t kLongestSocketPath = 107;

bool wants_tls(const ChannelOptions& options) {
  return options.tls || !options.tls_ca.empty() || !options.tls_cert.empty() ||
         !options.tls_key.empty();
}

absl::Status read_pem(const std::string& path, const char* kind, std::string& pem) {
  if (path.empty()) return absl::OkStatus();
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError(absl::StrCat("cannot read ", path));
  std::ostringstream text;
  text << file.rdbuf();
  pem = text.str();
  if (absl::StrContains(pem, "-----BEGIN ") && absl::StrContains(pem, kind)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(path, " holds no ", kind, " in PEM"));
}

absl::StatusOr<Credentials> tls_credentials(const ChannelOptions& options) {
  if (options.tls_cert.empty() != options.tls_key.empty()) {
    return absl::InvalidArgumentError("a client's certificate and its key go together");
  }
  grpc::SslCredentialsOptions pem;
  absl::Status status = read_pem(options.tls_ca, "CERTIFICATE", pem.pem_root_certs);
  if (status.ok()) status = read_pem(options.tls_cert, "CERTIFICATE", pem.pem_cert_chain);
  if (status.ok()) status = read_pem(options.tls_key, "PRIVATE KEY", pem.pem_private_key);
  if (!status.ok()) return status;
  return grpc::SslCredentials(pem);
}

/// The socket file that an address is of, as `unix:PATH` or `unix:///PATH`.
std::optional<std::string> socket_path_of(const std::string& address) {
  constexpr absl::string_view kScheme = "unix:";
  if (!absl::StartsWith(address, kScheme)) return std::nullopt;
  std::string path = address.substr(kScheme.size());
  if (absl::StartsWith(path, "///")) path.erase(0, 2);
  return path;
}

/// gRPC reads an address as a URI: what has a meaning there is written as `%XX`.
std::string target_of(const std::string& address) {
  const auto path = socket_path_of(address);
  if (!path) return address;
  std::string target = "unix:";
  for (const char character : *path) {
    const auto byte = static_cast<unsigned char>(character);
    if (absl::ascii_isalnum(byte) || absl::StrContains("/._-~", std::string(1, character))) {
      target.push_back(character);
    } else {
      absl::StrAppend(&target, "%", absl::Hex(byte, absl::kZeroPad2));
    }
  }
  return target;
}

/// gRPC would take a port of its own where there is none.
absl::Status check_address(const std::string& address) {
  if (const auto path = socket_path_of(address)) {
    return check_socket_path(*path, kLongestSocketPath);
  }
  if (absl::StrContains(address, "/") || absl::StartsWith(address, "unix-abstract:")) {
    return absl::OkStatus();  // in the words of gRPC's resolvers
  }
  const std::size_t colon = address.rfind(':');
  const std::string host = address.substr(0, colon);
  const bool is_bare_v6 = absl::StrContains(host, ":") && !absl::EndsWith(host, "]");
  if (colon == std::string::npos || is_bare_v6) {
    return absl::InvalidArgumentError(absl::StrCat("the server '", address,
                                                   "' has no port: write HOST:PORT, such as ",
                                                   is_bare_v6 ? absl::StrCat("[", address, "]")
                                                   : address.empty() ? "localhost"
                                                                     : address,
                                                   ":7447"));
  }
  std::uint32_t port = 0;
  if (!host.empty() && absl::SimpleAtoi(address.substr(colon + 1), &port) && port > 0 &&
      port <= 65535) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("the server '", address, "' is not HOST:PORT with a port from 1 to 65535"));
}

absl::Status check_token(const std::string& address, const ChannelOptions& options) {
  if (options.token.empty() || wants_tls(options) || options.token_in_plain ||
      is_loopback(address)) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(
      absl::StrCat("the token would go to ", address,
                   " unencrypted: use --tls or --tls-ca, or allow it with --token-in-plain"));
}

grpc::ChannelArguments channel_arguments() {
  grpc::ChannelArguments arguments;
  for (const TransportSetting& setting : kTransportSettings) {
    arguments.SetInt(setting.name, setting.value);
  }
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  // Tried again sooner than our own retries end.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 3000);
  return arguments;
}

/// Why there is no connection, where gRPC's own words would not tell what to do about it.
absl::Status explain_connection(const std::string& address,
                                bool tls,
                                const std::string& message) {
  const std::string lower = absl::AsciiStrToLower(message);
  const auto says = [&](const char* text) { return absl::StrContains(lower, text); };
  const auto for_ever = [&](const char* text) {
    return absl::InternalError(absl::StrCat(address, text));
  };
  if (says("wrong version number")) {
    return for_ever(" does not speak TLS: leave out --tls and its like");
  }
  if (says("certificate verify failed")) {
    return for_ever(
        " has a certificate that has expired or that nobody vouches for who is trusted here: "
        "see --tls-ca");
  }
  if (says("is not in peer certificate")) {
    return for_ever(" is not the name in the server's certificate");
  }
  if (!says("socket closed") && !says("connection reset"))
    return absl::UnavailableError(message);
  return absl::UnavailableError(absl::StrCat(
      address, tls ? " hung up: it may want a client's certificate (--tls-cert, --tls-key), or "
                     "one from another authority"
                   : " hung up: it may speak TLS (--tls, --tls-ca)"));
}

}  // namespace

void ServerChannel::seek(std::chrono::milliseconds time) const {
  const auto end = std::chrono::system_clock::now() + time;
  while (channel_->WaitForStateChange(channel_->GetState(/*try_to_connect=*/true), end)) {
  }
}

void ServerChannel::authorize(grpc::ClientContext& context) const {
  if (!authorization_.empty()) context.AddMetadata("authorization", authorization_);
}

absl::Status ServerChannel::explain(const absl::Status& status) const {
  const std::string message(status.message());
  if (absl::IsUnavailable(status) && absl::StrContains(message, "failed to connect")) {
    return explain_connection(address_, tls_, message);
  }
  if (!absl::IsUnauthenticated(status) || !authorization_.empty()) return status;
  absl::Status told(status.code(),
                    absl::StrCat(address_, " wants a token (--token-file): ", message));
  status.ForEachPayload([&](auto url, const auto& bytes) { told.SetPayload(url, bytes); });
  return told;
}

absl::StatusOr<ServerChannel> open_channel(const std::string& address,
                                           const ChannelOptions& options) {
  if (absl::Status status = check_address(address); !status.ok()) return status;
  if (absl::Status status = check_token(address, options); !status.ok()) return status;
  keep_grpc();
  grpc::ChannelArguments arguments = channel_arguments();
  Credentials credentials = grpc::InsecureChannelCredentials();
  ServerChannel opened;
  if (wants_tls(options)) {
    auto tls = tls_credentials(options);
    if (!tls.ok()) return tls.status();
    credentials = *std::move(tls);
    opened.tls_ = true;
  } else if (!options.token.empty()) {
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);  // which could be anywhere
  }
  opened.channel_ = grpc::CreateCustomChannel(target_of(address), credentials, arguments);
  opened.address_ = address;
  if (options.shared_memory) opened.shared_memory_path_ = socket_path_of(address).value_or("");
  if (!options.token.empty()) opened.authorization_ = absl::StrCat("Bearer ", options.token);
  return opened;
}

ServerChannel open_channel(const std::string& address) { return *open_channel(address, {}); }

}  // namespace tet
