#include "server/http/event_loop.h"

#include <array>
#include <csignal>
#include <sys/epoll.h>
#include <utility>

#include "core/base/contain.h"

namespace tet {

namespace {

constexpr int kMostEvents = 64;

// OpenSSL writes to sockets that the other side has closed.
void hold_broken_pipes() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

}  // namespace

EventLoop::EventLoop(std::chrono::milliseconds interval, Task tick)
    : interval_(interval), tick_(std::move(tick)), epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
  watch(wake_.number(), EPOLLIN, [this](std::uint32_t) { wake_.reset(); });
}

void EventLoop::stop() {
  if (!thread_.joinable()) return;
  post([this] { stopping_ = true; });
  thread_.join();
}

void EventLoop::start() {
  thread_ = std::thread([this] { run(); });
}

void EventLoop::post(Task task) {
  {
    const std::lock_guard lock(mutex_);
    posted_.push_back(std::move(task));
  }
  wake_.set();
}

void EventLoop::watch(int descriptor, std::uint32_t events, Watcher watcher) {
  watchers_[descriptor] = std::make_shared<Watcher>(std::move(watcher));
  control(EPOLL_CTL_ADD, descriptor, events);
}

void EventLoop::change(int descriptor, std::uint32_t events) {
  control(EPOLL_CTL_MOD, descriptor, events);
}

void EventLoop::forget(int descriptor) {
  control(EPOLL_CTL_DEL, descriptor, 0);
  watchers_.erase(descriptor);
}

void EventLoop::control(int operation, int descriptor, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.fd = descriptor;
  ::epoll_ctl(epoll_.number(), operation, descriptor, &event);
}

void EventLoop::run() {
  hold_broken_pipes();
  auto next_tick = std::chrono::steady_clock::now() + interval_;
  while (!stopping_ || held_ > 0) {
    wait();
    do_posted();
    if (std::chrono::steady_clock::now() < next_tick) continue;
    contain("http tick", tick_);
    next_tick = std::chrono::steady_clock::now() + interval_;
  }
  while (do_posted()) {
  }
}

void EventLoop::wait() {
  std::array<epoll_event, kMostEvents> events;
  const int count = ::epoll_wait(epoll_.number(), events.data(), kMostEvents,
                                 static_cast<int>(interval_.count()));
  for (int i = 0; i < count; ++i) {
    const epoll_event& event = events[static_cast<std::size_t>(i)];
    const auto found = watchers_.find(event.data.fd);
    if (found == watchers_.end()) continue;  // forgotten because of an event before
    const std::shared_ptr<Watcher> watcher = found->second;
    contain("http connection", [&] { (*watcher)(event.events); });
  }
}

/// False where there was nothing to do.
bool EventLoop::do_posted() {
  std::vector<Task> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(posted_);
  }
  for (const Task& task : tasks) contain("http task", task);
  return !tasks.empty();
}

}  // namespace tet
