#include "server/rpc/forwarded.h"

#include <string_view>

#include <absl/strings/escaping.h>
#include <grpc/grpc_security_constants.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

namespace tet {

namespace {

constexpr char kProofKey[] = "tetstream-forwarded-proof";
constexpr char kAddressKey[] = "tetstream-forwarded-address";
constexpr char kSubjectKey[] = "tetstream-forwarded-subject-bin";

/// Hexadecimal digits of 32 random bytes, others in each process. Without randomness there is
/// no proof, and nothing is believed.
const std::string& proof() {
  static const std::string text = [] {
    std::string bytes(32, '\0');
    const bool random = RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()),
                                   static_cast<int>(bytes.size())) == 1;
    return random ? absl::BytesToHexString(bytes) : std::string();
  }();
  return text;
}

std::string only_value(const grpc::ServerContextBase& context, const char* key) {
  const auto [first, last] = context.client_metadata().equal_range(key);
  if (first == last || std::next(first) != last) return {};
  return {first->second.data(), first->second.size()};
}

bool is_forwarded(const grpc::ServerContextBase& context) {
  const std::string given = only_value(context, kProofKey);
  return !proof().empty() && given.size() == proof().size() &&
         CRYPTO_memcmp(given.data(), proof().data(), given.size()) == 0;
}

}  // namespace

void forward_for(const ForwardedPeer& peer, grpc::ClientContext& context) {
  context.AddMetadata(kProofKey, proof());
  context.AddMetadata(kAddressKey, peer.address);
  if (!peer.subject.empty()) context.AddMetadata(kSubjectKey, peer.subject);
}

ForwardedPeer peer_of(const grpc::ServerContextBase& context) {
  if (is_forwarded(context)) {
    return {only_value(context, kAddressKey), only_value(context, kSubjectKey)};
  }
  const auto subject =
      context.auth_context()->FindPropertyValues(GRPC_X509_SUBJECT_PROPERTY_NAME);
  return {context.peer(), subject.empty()
                              ? std::string()
                              : std::string(subject.front().data(), subject.front().size())};
}

}  // namespace tet
