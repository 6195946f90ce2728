#include "client/command/arguments/server_options.h"

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "client/command/process/interruption.h"
#include "client/library/text_file.h"

namespace tet {
namespace {

constexpr const char* kGroup = "Server";

/// The file's only line.
absl::StatusOr<std::string> read_token(const std::string& path) {
  const absl::StatusOr<std::string> text = read_text_file(path, user_interruption());
  if (!text.ok())
    return absl::Status(text.status().code(),
                        absl::StrCat("the token: ", text.status().message()));
  std::string token(absl::StripAsciiWhitespace(*text));
  // Which a line's end is not.
  const bool printable = std::all_of(token.begin(), token.end(),
                                     [](unsigned char c) { return absl::ascii_isgraph(c); });
  if (!token.empty() && printable) return token;
  return absl::InvalidArgumentError(absl::StrCat(path, " is not one line with a token"));
}

}  // namespace

CLI::Option* describe_server(CLI::App& app, ServerArguments& arguments) {
  ChannelOptions& channel = arguments.channel;
  auto* const server =
      app.add_option(
             "--server", arguments.address,
             "HOST:PORT of a tetstreamd or unix:PATH of its socket file, or several with "
             "commas between")
          ->group(kGroup);
  app.add_flag("--tls", channel.tls, "Speak TLS; the system's roots vouch for the server")
      ->group(kGroup);
  app.add_option("--tls-ca", channel.tls_ca,
                 "Speak TLS; PEM file of who vouches for the server")
      ->group(kGroup);
  app.add_option("--tls-cert", channel.tls_cert, "PEM file of the client's own certificate")
      ->group(kGroup);
  app.add_option("--tls-key", channel.tls_key, "PEM file of that certificate's private key")
      ->group(kGroup);
  app.add_option("--token-file", arguments.token_file,
                 "File of one line: the token of every call")
      ->envname("TETSTREAM_TOKEN_FILE")
      ->group(kGroup);
  app.add_flag("--token-in-plain", channel.token_in_plain,
               "Send the token even where it can be read on its way")
      ->group(kGroup);
  app.add_flag("!--no-shared-memory", channel.shared_memory,
               "Have chunks sent, also from a server whose socket file is on this host")
      ->group(kGroup);
  return server;
}

absl::StatusOr<ChannelOptions> understand_server(const ServerArguments& arguments) {
  ChannelOptions channel = arguments.channel;
  if (arguments.token_file.empty()) return channel;
  absl::StatusOr<std::string> token = read_token(arguments.token_file);
  if (!token.ok()) return token.status();
  channel.token = *std::move(token);
  return channel;
}

}  // namespace tet
