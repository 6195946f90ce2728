#include "server/http/http_tls.h"

#include <string>
#include <utility>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

struct BioFree {
  void operator()(BIO* bio) const noexcept { BIO_free(bio); }
};
struct CertificateFree {
  void operator()(X509* certificate) const noexcept { X509_free(certificate); }
};
struct KeyFree {
  void operator()(EVP_PKEY* key) const noexcept { EVP_PKEY_free(key); }
};
using PemReader = std::unique_ptr<BIO, BioFree>;
using PemCertificate = std::unique_ptr<X509, CertificateFree>;

PemReader pem_reader(const std::string& pem) {
  return PemReader(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
}

PemCertificate next_certificate(BIO* reader) {
  return PemCertificate(PEM_read_bio_X509(reader, nullptr, nullptr, nullptr));
}

/// The server's own certificate comes first, and those that lead to its root follow.
bool use_chain(SSL_CTX* context, const std::string& pem) {
  const PemReader reader = pem_reader(pem);
  const PemCertificate own = next_certificate(reader.get());
  if (own == nullptr || SSL_CTX_use_certificate(context, own.get()) != 1) return false;
  while (PemCertificate other = next_certificate(reader.get())) {
    if (SSL_CTX_add0_chain_cert(context, other.get()) != 1) return false;
    static_cast<void>(other.release());  // the context owns it now
  }
  return true;
}

bool use_key(SSL_CTX* context, const std::string& pem) {
  const std::unique_ptr<EVP_PKEY, KeyFree> key(
      PEM_read_bio_PrivateKey(pem_reader(pem).get(), nullptr, nullptr, nullptr));
  return key != nullptr && SSL_CTX_use_PrivateKey(context, key.get()) == 1;
}

bool ask_clients(SSL_CTX* context, const std::string& pem) {
  if (pem.empty()) return true;
  const PemReader reader = pem_reader(pem);
  while (const PemCertificate root = next_certificate(reader.get())) {
    X509_STORE_add_cert(SSL_CTX_get_cert_store(context), root.get());
    SSL_CTX_add_client_CA(context, root.get());
  }
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  return true;
}

}  // namespace

HttpTls::Context HttpTls::context_of(const TlsMaterial& material) {
  Context context(SSL_CTX_new(TLS_server_method()));
  if (context == nullptr) return nullptr;
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                         SSL_OP_NO_TICKET | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_mode(context.get(), SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                      SSL_MODE_RELEASE_BUFFERS);
  const bool good = use_chain(context.get(), material.cert) &&
                    use_key(context.get(), material.key) &&
                    ask_clients(context.get(), material.client_ca);
  ERR_clear_error();  // where the last certificate ended
  return good ? std::move(context) : nullptr;
}

SslSession HttpTls::begin() {
  if (const auto newer = tls_.newer_than(generation_)) {
    if (Context made = context_of(*newer)) {
      context_ = std::move(made);
    } else {
      log_event(spdlog::level::err, "http_tls_kept");
    }
  }
  return SslSession(context_ == nullptr ? nullptr : SSL_new(context_.get()));
}

}  // namespace tet
