#include "server/rpc/tls.h"

#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using PrivateKey = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;

// gRPC frees what it made of the old certificate though a handshake that has just asked for it
// may be about to begin (its issue 36693). None asks while another's answer is awaited, so the
// one before has this time to begin.
constexpr absl::Duration kUntilHandshakeBegins = absl::Milliseconds(100);

// Others than the owner's group: the group is how several services share one key.
constexpr mode_t kOthers = 007;

Bio reader_of(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

// OpenSSL would ask for it on the terminal.
int no_passphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) {
  return -1;
}

absl::StatusOr<Certificate> first_certificate(const std::string& path, const std::string& pem) {
  Certificate certificate(
      PEM_read_bio_X509(reader_of(pem).get(), nullptr, no_passphrase, nullptr));
  if (certificate) return certificate;
  return absl::InvalidArgumentError(absl::StrCat(path, " holds no certificate in PEM"));
}

absl::StatusOr<PrivateKey> private_key(const std::string& path, const std::string& pem) {
  PrivateKey key(
      PEM_read_bio_PrivateKey(reader_of(pem).get(), nullptr, no_passphrase, nullptr));
  if (key) return key;
  return absl::InvalidArgumentError(
      absl::StrCat(path, " holds no private key in PEM without a passphrase"));
}

absl::Time end_of(const X509& certificate) {
  std::tm time{};
  ASN1_TIME_to_tm(X509_get0_notAfter(&certificate), &time);
  return absl::FromTM(time, absl::UTCTimeZone());
}

absl::Status check(const TlsFiles& files, TlsMaterial& material) {
  const auto certificate = first_certificate(files.cert, material.cert);
  if (!certificate.ok()) return certificate.status();
  const auto key = private_key(files.key, material.key);
  if (!key.ok()) return key.status();
  if (X509_check_private_key(certificate->get(), key->get()) != 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("the key in ", files.key, " is not that of ", files.cert));
  }
  if (!files.client_ca.empty()) {
    const auto root = first_certificate(files.client_ca, material.client_ca);
    if (!root.ok()) return root.status();
  }
  material.subject = subject_of(**certificate);
  material.expires = end_of(**certificate);
  return absl::OkStatus();
}

void log_certificate(const char* event, const TlsMaterial& material) {
  const bool expired = material.expires < absl::Now();
  log_event(expired ? spdlog::level::warn : spdlog::level::info, event,
            {{"subject", material.subject},
             {"expires", absl::FormatTime(material.expires, absl::UTCTimeZone())},
             {"is_expired", expired}});
}

/// gRPC's C++ credentials cannot be replaced; those of its C library can.
class FetchedCredentials final : public grpc::ServerCredentials {
 public:
  explicit FetchedCredentials(grpc_server_credentials* credentials)
      : credentials_(credentials) {}
  ~FetchedCredentials() override { grpc_server_credentials_release(credentials_); }

  void SetAuthMetadataProcessor(
      const std::shared_ptr<grpc::AuthMetadataProcessor>& /*processor*/) override {}

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override {
    return grpc_server_add_http2_port(server, address.c_str(), credentials_);
  }

  grpc_server_credentials* const credentials_;
};

}  // namespace

std::string subject_of(const X509& certificate) {
  const Bio text(BIO_new(BIO_s_mem()));
  X509_NAME_print_ex(text.get(), X509_get_subject_name(&certificate), 0, XN_FLAG_RFC2253);
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(text.get(), &bytes);
  return {bytes, static_cast<std::size_t>(size)};
}

absl::StatusOr<TlsMaterial> load_tls(const TlsFiles& files) {
  TlsMaterial material;
  const auto read = [](const std::string& path, mode_t forbidden, std::string& text) {
    if (path.empty()) return absl::OkStatus();
    auto found = read_small_file(path, forbidden);
    if (found.ok()) text = std::move(*found);
    return found.status();
  };
  absl::Status status = read(files.cert, 0, material.cert);
  if (status.ok()) status = read(files.key, kOthers, material.key);
  if (status.ok()) status = read(files.client_ca, 0, material.client_ca);
  if (status.ok()) status = check(files, material);
  if (!status.ok()) return status;
  return material;
}

absl::StatusOr<std::unique_ptr<ServerTls>> ServerTls::open(TlsFiles files) {
  std::unique_ptr<ServerTls> tls(new ServerTls(std::move(files)));
  tls->watch_.changed();
  if (const absl::Status status = tls->load(); !status.ok()) return status;
  log_certificate("tls", tls->material_);
  return tls;
}

ServerTls::ServerTls(TlsFiles files)
    : files_(std::move(files)), watch_({files_.cert, files_.key, files_.client_ca}) {}

absl::Status ServerTls::load() {
  auto material = load_tls(files_);
  if (!material.ok()) return material.status();
  material_ = *std::move(material);
  handed_out_ = false;
  ++generation_;
  return absl::OkStatus();
}

std::shared_ptr<grpc::ServerCredentials> ServerTls::credentials() {
  const auto clients = files_.client_ca.empty()
                           ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                           : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
  auto* const options = grpc_ssl_server_credentials_create_options_using_config_fetcher(
      clients, &ServerTls::fetch, this);
  return std::make_shared<FetchedCredentials>(
      grpc_ssl_server_credentials_create_with_options(options));
}

ServerTls::Reload ServerTls::fetch(void* self, grpc_ssl_server_certificate_config** config) {
  return static_cast<ServerTls*>(self)->fetch(config);
}

/// Under the lock; whether there is something new.
bool ServerTls::reload() {
  if (!watch_.changed()) return false;
  const absl::Status status = load();
  keeps_old_ = !status.ok();
  if (status.ok()) {
    log_certificate("tls_reloaded", material_);
  } else {
    log_event(spdlog::level::err, "tls_kept", {{"message", std::string(status.message())}});
  }
  return status.ok();
}

bool ServerTls::keeps_old() {
  const std::lock_guard lock(mutex_);
  reload();
  return keeps_old_;
}

absl::Time ServerTls::expires() {
  const std::lock_guard lock(mutex_);
  return material_.expires;
}

std::optional<TlsMaterial> ServerTls::newer_than(std::uint64_t& generation) {
  const std::lock_guard lock(mutex_);
  reload();
  if (generation == generation_) return std::nullopt;
  generation = generation_;
  return material_;
}

// Called when the port opens and before each handshake.
ServerTls::Reload ServerTls::fetch(grpc_ssl_server_certificate_config** config) {
  const std::lock_guard lock(mutex_);
  reload();
  if (std::exchange(handed_out_, true)) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
  if (generation_ > 1) absl::SleepFor(kUntilHandshakeBegins);
  // The library insists on roots; where it asks for no certificate it does nothing with them.
  const std::string& roots = files_.client_ca.empty() ? material_.cert : material_.client_ca;
  const grpc_ssl_pem_key_cert_pair pair{material_.key.c_str(), material_.cert.c_str()};
  *config = grpc_ssl_server_certificate_config_create(roots.c_str(), &pair, 1);
  return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
}

}  // namespace tet
