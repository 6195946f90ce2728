#include "server/jobs/store/postgres_listener.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <poll.h>
#include <utility>

#include "core/base/contain.h"

namespace tet {

namespace {

// Notifications of a busy process are sent together.
constexpr auto kBetweenNotifications = std::chrono::milliseconds(5);
constexpr auto kBetweenConnects = std::chrono::milliseconds(200);

}  // namespace

PostgresListener::PostgresListener(std::string connection, absl::Duration poll)
    : connection_string_(std::move(connection)), poll_(poll) {
  thread_ = std::thread([this] { run(); });
}

PostgresListener::~PostgresListener() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.set();
  thread_.join();
}

void PostgresListener::announce() {
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    first = !std::exchange(pending_, true);
    ++signal_;
    raised_.notify_all();
  }
  if (first) wake_.set();
}

std::uint64_t PostgresListener::signal() {
  const std::lock_guard lock(mutex_);
  return signal_;
}

void PostgresListener::raise() {
  const std::lock_guard lock(mutex_);
  ++signal_;
  raised_.notify_all();
}

void PostgresListener::wait(std::uint64_t seen, absl::Duration timeout) {
  const auto most = absl::ToChronoNanoseconds(std::min(timeout, poll_));
  std::unique_lock lock(mutex_);
  raised_.wait_for(lock, most, [&] { return signal_ != seen; });
}

bool PostgresListener::listen() {
  if (connection_ && connection_->usable()) return true;
  connection_.reset();
  auto opened = PostgresConnection::open(connection_string_);
  if (!opened.ok() || !(*opened)->run_script("LISTEN tetstream_jobs").ok()) return false;
  connection_ = *std::move(opened);
  raise();  // who knows what was missed
  return true;
}

void PostgresListener::run() {
  bool stopping = false;
  while (!stopping) {
    contain("listening to PostgreSQL", [&] { stopping = !tell_and_listen(); });
  }
}

/// False when it is to end.
bool PostgresListener::tell_and_listen() {
  const bool listening = listen();
  if (!listening) std::this_thread::sleep_for(kBetweenConnects);
  bool tell = false;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return false;
    tell = listening && std::exchange(pending_, false);
  }
  if (tell && connection_->run_script("NOTIFY tetstream_jobs").ok()) {
    std::this_thread::sleep_for(kBetweenNotifications);
  }
  if (listening) listen_once();
  return true;
}

void PostgresListener::listen_once() {
  std::array<pollfd, 2> sources{};
  sources[0] = {connection_->socket(), POLLIN, 0};
  sources[1] = {wake_.number(), POLLIN, 0};
  ::poll(sources.data(), sources.size(), static_cast<int>(absl::ToInt64Milliseconds(poll_)));
  wake_.reset();
  const auto notified = connection_->take_notifications();
  if (!notified.ok()) {
    connection_.reset();
  } else if (*notified) {
    raise();
  }
}

}  // namespace tet
