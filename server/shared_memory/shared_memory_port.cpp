#include "server/shared_memory/shared_memory_port.h"

#include <cerrno>
#include <sys/epoll.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <openssl/rand.h>

#include "core/base/posix/io_error.h"
#include "core/base/posix/packet_socket.h"
#include "proto/wire/side_messages.h"

namespace tet {

namespace {

constexpr int kBacklog = 256;
/// A call comes right after the connection that it names, but may wait for its turn.
constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::milliseconds kTick{1000};
/// The kernel's address of a socket file holds so much.
constexpr std::size_t kMaxSidePath = 107;

/// Empty where there is no randomness.
std::string random_token() {
  std::string token(SideConnection::kTokenBytes, '\0');
  auto* const bytes = reinterpret_cast<unsigned char*>(token.data());
  return RAND_bytes(bytes, static_cast<int>(token.size())) == 1 ? token : std::string();
}

}  // namespace

absl::StatusOr<std::unique_ptr<SharedMemoryPort>> SharedMemoryPort::open(
    const std::string& grpc_path, mode_t rights) {
  auto file = SocketFile::prepare(absl::StrCat(grpc_path, kSideSocketEnding), kMaxSidePath);
  if (!file.ok()) return file.status();
  Descriptor listener = listen_for_packets(file->bind_path(), kBacklog);
  if (!listener.is_open()) return io_error("listen on", file->path());
  if (absl::Status status = file->publish(rights); !status.ok()) return status;
  return std::unique_ptr<SharedMemoryPort>(
      new SharedMemoryPort(*std::move(file), std::move(listener)));
}

SharedMemoryPort::SharedMemoryPort(SocketFile file, Descriptor listener)
    : file_(std::move(file)),
      listener_(std::move(listener)),
      watch_(loop_, listener_.number(), [this] { return accept_one(); }),
      loop_(kTick, [this] { tick(); }) {
  watch_.begin();
  loop_.start();
}

SharedMemoryPort::~SharedMemoryPort() { loop_.stop(); }

SideClaim SharedMemoryPort::claim(const std::string& token) {
  const std::lock_guard lock(mutex_);
  const auto found = waiting_.find(token);
  if (found == waiting_.end()) return {};
  SideClaim claimed(*this, std::move(found->second.connection), found->second.user);
  waiting_.erase(found);
  return claimed;
}

Accepted SharedMemoryPort::accept_one() {
  Descriptor socket = accept_packets(listener_);
  if (!socket.is_open()) return accepted_none(errno);
  add(std::move(socket));
  return Accepted::kOne;
}

void SharedMemoryPort::tick() {
  end_old();
  watch_.look_again();
}

/// False where there is no room for another: it is closed, and the client goes without.
bool SharedMemoryPort::add(Descriptor socket) {
  const auto user = user_of_peer(socket);
  std::string token = random_token();
  if (!user || token.empty()) return false;
  const auto connection = std::make_shared<SideConnection>(std::move(socket), std::move(token));
  if (!wait_for_claim(connection, *user, Kind::kUnclaimed)) return false;
  heed(connection);
  if (connection->tell_token()) return true;
  forget(connection);
  return false;
}

/// False where there are enough of that kind, or the client is gone.
bool SharedMemoryPort::wait_for_claim(const std::shared_ptr<SideConnection>& connection,
                                      uid_t user,
                                      Kind kind) {
  const std::lock_guard lock(mutex_);
  if (connection->is_over()) return false;
  const bool rests = kind == Kind::kResting;
  std::size_t all = 0, of_user = 0;
  for (const auto& [token, other] : waiting_) {
    if (other.kind != kind) continue;
    ++all;
    if (other.user == user) ++of_user;
  }
  if (all >= (rests ? kMostResting : kMostUnclaimed) ||
      of_user >= (rests ? kMostRestingOfUser : kMostUnclaimedOfUser)) {
    return false;
  }
  waiting_.emplace(connection->token(), Waiting{connection, user, kind, Clock::now()});
  return true;
}

void SharedMemoryPort::heed(const std::shared_ptr<SideConnection>& connection) {
  loop_.watch(connection->socket().number(), EPOLLIN | EPOLLRDHUP,
              [this, connection](std::uint32_t) {
                if (!connection->take()) forget(connection);
              });
}

void SharedMemoryPort::forget(const std::shared_ptr<SideConnection>& connection) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.erase(connection->token());
  }
  loop_.forget(connection->socket().number());
}

void SharedMemoryPort::end_old() {
  std::vector<std::shared_ptr<SideConnection>> old;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(waiting_, [&](const auto& entry) {
      const bool is_old = Clock::now() - entry.second.since > kPatience;
      if (is_old) old.push_back(entry.second.connection);
      return is_old;  // nobody claims it any more
    });
  }
  for (const auto& connection : old) loop_.forget(connection->socket().number());
}

SideClaim& SideClaim::operator=(SideClaim&& other) noexcept {
  end();
  port_ = other.port_;
  connection_ = std::exchange(other.connection_, nullptr);
  user_ = other.user_;
  return *this;
}

// Root overrules the rights that keep other users from writing, and so may its containers'.
Readers SideClaim::readers() const noexcept {
  return user_ == 0 || user_ == ::geteuid() ? Readers::kAny : Readers::kOtherUser;
}

void SideClaim::end() noexcept {
  if (const auto ended = std::exchange(connection_, nullptr)) ended->close();
}

void SideClaim::give_back() {
  if (connection_ == nullptr) return;
  if (port_->wait_for_claim(connection_, user_, SharedMemoryPort::Kind::kResting))
    connection_ = nullptr;
  end();
}

}  // namespace tet
