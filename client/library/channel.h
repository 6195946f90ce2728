// Connections to a server, as all of our clients open them.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <absl/status/statusor.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

namespace tet {

/// How a server is spoken to, and who speaks. Files are PEM.
struct ChannelOptions {
  bool tls = false;      ///< also when any file is given
  std::string tls_ca;    ///< who signs the server's certificate; empty: the system's roots
  std::string tls_cert;  ///< the client's certificate, where the server asks for one
  std::string tls_key;   ///< and its private key
  std::string token;     ///< goes with every call
  bool token_in_plain = false;  ///< even where others can read it on its way
  bool shared_memory = true;    ///< ask for it where the server has a socket file here
};

/// A connection of its own, never shared with another channel of this process, and the token of
/// its calls. Copies share the connection. Thread-safe.
class ServerChannel {
 public:
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
  /// The server's socket file, beside which there may be shared memory; empty: none.
  const std::string& shared_memory_path() const { return shared_memory_path_; }

  /// Lets `time` pass and the server be sought meanwhile: gRPC goes on with that only while
  /// somebody waits for it, and else looks every five seconds.
  void seek(std::chrono::milliseconds time) const;

  /// Gives a call the token. Do this for each call before it starts.
  void authorize(grpc::ClientContext& context) const;

  /// A call's status, with a message that says what to do where the two ends do not speak the
  /// same language; then the code is kInternal, as trying again would not help.
  absl::Status explain(const absl::Status& status) const;

 private:
  friend absl::StatusOr<ServerChannel> open_channel(const std::string& address,
                                                    const ChannelOptions& options);
  std::shared_ptr<grpc::Channel> channel_;
  std::string address_;
  std::string authorization_;  ///< empty: none
  std::string shared_memory_path_;
  bool tls_ = false;
};

/// Does not wait for the server; a lost one is sought again after 0.1 to 3 seconds.
/// Errors: kNotFound or kInvalidArgument (a file), kFailedPrecondition (a token that others
/// could read on its way).
absl::StatusOr<ServerChannel> open_channel(const std::string& address,
                                           const ChannelOptions& options);

/// Plain, and without a token.
ServerChannel open_channel(const std::string& address);

}  // namespace tet
