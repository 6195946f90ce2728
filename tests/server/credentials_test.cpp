// Who may call: every credential with every method over every kind of connection.
#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/channel.h"
#include "tests/server/authority.h"
#include "tests/server/every_call.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"
#include "tests/server/token_book.h"
#include "tests/server/until_healthy.h"

namespace tet::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr char kAllScopes[] =
    "\"grids.read\", \"grids.write\", \"mesh\", \"jobs.read\", \"jobs.write\", "
    "\"workers.read\"";

/// What a call says of its caller, and how it ends unless the token is good for the method.
struct Credential {
  std::string authorization;  ///< empty: none
  std::string refusal;        ///< empty: none
  std::string scopes;
};

class CredentialsTest : public ServiceTest {
 protected:
  CredentialsTest() : authority_(folder_, "authority"), strangers_(folder_, "strangers") {}

  void use_tls(const CertifiedKey& server) {
    config_.tls_cert = server.cert;
    config_.tls_key = server.key;
  }

  /// Starts a server with tokens, and stores a grid in the namespace "ours" by means of
  /// `channel`.
  void start_with_tokens(ChannelOptions channel) {
    config_.tokens = tokens_.file();
    config_.jobs.clear();
    config_.job_workers = 0;
    const std::string far_past = "2000-01-01T00:00:00Z";
    const auto bearer = [](const std::string& token) { return "Bearer " + token; };
    channel.token = tokens_.add("all", kAllScopes, "ours");
    const auto refused = [this](const std::string& authorization, const std::string& reason) {
      credentials_.push_back({authorization, "tetstream/" + reason, ""});
    };
    refused("", "TOKEN_MISSING");
    refused("Bearer secret-of-nobody", "TOKEN_UNKNOWN");
    refused("Basic secret-of-all", "TOKEN_UNKNOWN");
    refused(bearer(tokens_.add("late", kAllScopes, "ours", far_past)), "TOKEN_EXPIRED");
    for (const std::string name :
         {"grids.read", "grids.write", "mesh", "jobs.read", "jobs.write", "workers.read"}) {
      const std::string scope = '"' + name + '"';
      const std::string token =
          tokens_.add("only-" + std::to_string(credentials_.size()), scope, "ours");
      credentials_.push_back({bearer(token), "tetstream/SCOPE_MISSING", scope});
    }
    credentials_.push_back({bearer("secret-of-all"), "", kAllScopes});
    auto server = Server::start(config_);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    const auto client = MeshClient::connect(server_->address(), channel);
    ASSERT_TRUE(client.ok()) << client.status();
    const auto name = (*client)->upload_file(ball_file(8), {}, never_);
    ASSERT_TRUE(name.ok()) << name.status();
    calls_ = every_call_about(*name);
  }

  grpc::Status make(const EveryCall& call,
                    const std::shared_ptr<grpc::Channel>& channel,
                    const std::string& authorization) {
    const grpc::Status status = asked_until_healthy([&] {
      grpc::ClientContext context;
      if (!authorization.empty()) context.AddMetadata("authorization", authorization);
      return call.make(channel, context);
    });
    EXPECT_THAT(status.error_message() + status.error_details(), Not(HasSubstr("secret-of-")));
    return status;
  }

  std::shared_ptr<grpc::Channel> channel_of(const ChannelOptions& options) {
    const auto channel = open_channel(server_->address(), options);
    EXPECT_TRUE(channel.ok()) << channel.status();
    return channel->channel();
  }

  /// Each credential with each method; returns how many pairs there were.
  int expect_matrix(const ChannelOptions& options) {
    const auto channel = channel_of(options);
    int pairs = 0;
    for (const Credential& credential : credentials_) {
      for (const EveryCall& call : calls_) {
        const grpc::Status status = make(call, channel, credential.authorization);
        const bool good = !credential.scopes.empty() &&
                          credential.scopes.find(call.scope) != std::string::npos;
        EXPECT_EQ(status.ok() ? "" : reason_of(status), good ? call.reason : credential.refusal)
            << call.method << " " << status.error_message();
        ++pairs;
      }
    }
    EXPECT_TRUE(comes_to_serve(*MeshClient::connect(server_->address(), options).value()));
    return pairs;
  }

  /// No method of any service is reached, whatever the token.
  void expect_no_connection(const ChannelOptions& options) {
    const auto channel = channel_of(options);
    for (const Credential& credential : credentials_) {
      for (const EveryCall& call : calls_) {
        const grpc::Status status = make(call, channel, credential.authorization);
        EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << call.method;
      }
    }
    const auto client = MeshClient::connect(server_->address(), options,
                                            {.attempts = 2, .first_backoff_ms = 1});
    const auto health = client.value()->check_health("readiness", never_);
    EXPECT_TRUE(absl::IsInternal(health) || absl::IsUnavailable(health)) << health;
  }

  ChannelOptions trusting(const Authority& authority) const {
    ChannelOptions options;
    options.tls_ca = authority.cert();
    return options;
  }

  ChannelOptions presenting(const CertifiedKey& client) const {
    ChannelOptions options = trusting(authority_);
    options.tls_cert = client.cert;
    options.tls_key = client.key;
    return options;
  }

  TokenBook tokens_{folder_};
  Authority authority_, strangers_;
  std::vector<Credential> credentials_;
  std::vector<EveryCall> calls_;
};

TEST_F(CredentialsTest, DecideOnEachMethodInPlain) {
  start_with_tokens({});
  EXPECT_EQ(expect_matrix({}), 11 * 21);
}

TEST_F(CredentialsTest, DecideOnEachMethodOverTls) {
  use_tls(authority_.sign("server"));
  start_with_tokens(trusting(authority_));
  EXPECT_EQ(expect_matrix(trusting(authority_)), 11 * 21);
  expect_no_connection({});
  expect_no_connection(trusting(strangers_));
}

TEST_F(CredentialsTest, DecideOnEachMethodWithClientCertificates) {
  use_tls(authority_.sign("server"));
  config_.tls_client_ca = authority_.cert();
  const ChannelOptions right = presenting(authority_.sign("client"));
  start_with_tokens(right);
  EXPECT_EQ(expect_matrix(right), 11 * 21);
  expect_no_connection({});
  expect_no_connection(trusting(authority_));
  expect_no_connection(presenting(strangers_.sign("stranger")));
  expect_no_connection(presenting(authority_.sign("expired-client", 0)));
}

TEST_F(CredentialsTest, OfAServerThatExpiredAreNotTaken) {
  use_tls(authority_.sign("server"));
  start_with_tokens(trusting(authority_));
  const CertifiedKey expired = authority_.sign("expired", 0);
  std::filesystem::rename(expired.key, config_.tls_key);
  std::filesystem::rename(expired.cert, config_.tls_cert);
  expect_no_connection(trusting(authority_));
}

TEST_F(CredentialsTest, DoNotReachAPlainServerOverTls) {
  start_with_tokens({});
  expect_no_connection(trusting(authority_));
}

/// How a call to server reflection ends.
grpc::StatusCode ask_for_reflection(const std::shared_ptr<grpc::Channel>& channel) {
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  const grpc::Slice nothing;
  grpc::ByteBuffer request(&nothing, 1), response;
  std::promise<grpc::StatusCode> code;
  stub.UnaryCall(&context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", {},
                 &request, &response,
                 [&code](const grpc::Status& status) { code.set_value(status.error_code()); });
  return code.get_future().get();
}

TEST_F(CredentialsTest, AreNotNeededForHealthAndTurnReflectionOff) {
  start_with_tokens({});
  for (const char* service : {"", "liveness", "readiness"}) {
    EXPECT_TRUE(comes_to_serve(*MeshClient::connect(server_->address()), service));
  }
  EXPECT_EQ(ask_for_reflection(channel_of({})), grpc::StatusCode::UNIMPLEMENTED);
  server_.reset();
  config_.reflection = "on";
  start();
  EXPECT_NE(ask_for_reflection(channel_of({})), grpc::StatusCode::UNIMPLEMENTED);
}

TEST_F(CredentialsTest, AreNeverLogged) {
  testing::internal::CaptureStderr();
  start_logging("trace");
  start_with_tokens({});
  expect_matrix({});
  tokens_.write("[[token]]\nname = \"secret-of-file\"\n");
  expect_matrix({});
  server_.reset();
  start_logging("error");
  flush_log(kGenerousEnd);
  const std::string log = testing::internal::GetCapturedStderr();
  for (const char* shown : {"tokens_kept", "UNAUTHENTICATED", "PERMISSION_DENIED"}) {
    EXPECT_NE(log.find(shown), std::string::npos) << shown;
  }
  EXPECT_EQ(log.find("secret-of-"), std::string::npos);
}

TEST_F(CredentialsTest, ChangeWhenTheFileOfTokensDoes) {
  start_with_tokens({});
  const EveryCall& list = calls_[2];
  const auto channel = channel_of({});
  const auto reason_for = [&](const std::string& name) {
    const grpc::Status status = make(list, channel, "Bearer secret-of-" + name);
    return status.ok() ? "ok" : reason_of(status);
  };
  EXPECT_EQ(reason_for("new"), "tetstream/TOKEN_UNKNOWN");
  tokens_.add("new", kAllScopes, "ours");
  EXPECT_EQ(reason_for("new"), "ok");
  tokens_.write("this is no TOML");
  EXPECT_EQ(reason_for("new"), "ok");
  std::filesystem::remove(tokens_.file());
  EXPECT_EQ(reason_for("new"), "ok");
  tokens_.write("");
  EXPECT_EQ(reason_for("new"), "tetstream/TOKEN_UNKNOWN");
  EXPECT_EQ(reason_for("all"), "tetstream/TOKEN_UNKNOWN");
}

TEST_F(CredentialsTest, OfTheServerChangeWhileAStreamRuns) {
  use_tls(authority_.sign("server"));
  start_with_tokens(trusting(authority_));
  ChannelOptions options = trusting(authority_);
  options.token = "secret-of-all";
  const auto client = MeshClient::connect(server_->address(), options);
  const auto name = (*client)->upload_file(ball_file(40), {}, never_);
  ASSERT_TRUE(name.ok()) << name.status();
  v1::StreamMeshRequest request;
  request.mutable_mesh()->set_name(*name);
  request.mutable_mesh()->set_levels(0);
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer secret-of-all");
  const auto stub = v1::MeshService::NewStub(channel_of(trusting(authority_)));
  const auto reader = stub->StreamMesh(&context, request);
  v1::MeshEvent event;
  ASSERT_TRUE(reader->Read(&event));

  const CertifiedKey renewed = strangers_.sign("renewed");
  std::filesystem::rename(renewed.key, config_.tls_key);
  std::filesystem::rename(renewed.cert, config_.tls_cert);
  expect_no_connection(trusting(authority_));
  EXPECT_EQ(expect_matrix(trusting(strangers_)), 11 * 21);
  folder_.write("server.pem", "-----BEGIN CERTIFICATE-----\nbroken\n");
  EXPECT_EQ(expect_matrix(trusting(strangers_)), 11 * 21);
  while (reader->Read(&event)) {
  }
  EXPECT_TRUE(event.has_trailer());
  EXPECT_TRUE(reader->Finish().ok());
}

TEST_F(CredentialsTest, OfTheServerAreCheckedBeforeItStarts) {
  const CertifiedKey server = authority_.sign("server");
  const CertifiedKey other = authority_.sign("other");
  const auto refusal = [this](std::string cert, std::string key, std::string client_ca) {
    config_.tls_cert = std::move(cert);
    config_.tls_key = std::move(key);
    config_.tls_client_ca = std::move(client_ca);
    const auto started = Server::start(config_);
    EXPECT_TRUE(absl::IsInvalidArgument(started.status())) << started.status();
    return std::string(started.status().message());
  };
  const std::string text = folder_.write("text", "hello");
  std::filesystem::permissions(text, std::filesystem::perms(0600));
  EXPECT_THAT(refusal(server.cert, "", ""), HasSubstr("tls_cert and tls_key go together"));
  EXPECT_THAT(refusal("", "", server.cert), HasSubstr("tls_client_ca needs tls_cert"));
  EXPECT_THAT(refusal("/nowhere", server.key, ""), HasSubstr("/nowhere: cannot open"));
  EXPECT_THAT(refusal(text, server.key, ""), HasSubstr("text holds no certificate in PEM"));
  EXPECT_THAT(refusal(server.cert, text, ""), HasSubstr("holds no private key in PEM"));
  EXPECT_THAT(refusal(server.cert, other.key, ""), HasSubstr("other.key is not that of"));
  EXPECT_THAT(refusal(server.cert, server.key, text), HasSubstr("text holds no certificate"));
  std::filesystem::permissions(server.key, std::filesystem::perms(0644));
  EXPECT_THAT(refusal(server.cert, server.key, ""), HasSubstr("can be read by others"));
}

}  // namespace
}  // namespace tet::test
