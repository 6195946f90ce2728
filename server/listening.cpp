#include "server/listening.h"

#include <string>

#include <absl/strings/str_cat.h>

#include "proto/wire/loopback.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

void warn(const std::string& listen, const std::string& message) {
  log_event(spdlog::level::warn, "exposed", {{"listen", listen}, {"message", message}});
}

void warn_of_port(const Config& config, const std::string& listen) {
  const bool plain = config.tls_cert.empty();
  const bool anyone = config.tokens.empty() && config.tls_client_ca.empty();
  if (listen.empty() || is_loopback(listen) || (!plain && !anyone)) return;
  const char* const who = anyone ? "anyone who reaches this port may use it" : "";
  const char* const how = plain ? "what is sent, tokens too, can be read on the way" : "";
  warn(listen, absl::StrCat(who, anyone && plain ? ", and " : "", how));
}

}  // namespace

absl::Status check_listening(const Config& config) {
  if (!config.listen.empty()) return absl::OkStatus();
  if (config.listen_unix.empty()) {
    return absl::InvalidArgumentError(
        "listen and listen_unix are both empty: give one of them");
  }
  if (config.port_file.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError("port_file needs a port: give listen, too");
}

mode_t socket_rights(const Config& config) {
  return static_cast<mode_t>(std::stoul(config.listen_unix_mode, nullptr, 8));
}

void warn_if_exposed(const Config& config) {
  warn_of_port(config, config.listen);
  warn_of_port(config, config.http_listen);
  const bool anyone = config.listen_unix_mode == "666" && config.tokens.empty();
  if (config.listen_unix.empty() || !anyone) return;
  warn(absl::StrCat("unix:", config.listen_unix),
       "every user of this host may use this socket");
}

}  // namespace tet
