#include "server/disk_threads.h"

#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

namespace tet {

struct DiskThreads::Impl {
  explicit Impl(int threads) : pool(static_cast<std::size_t>(threads)) {}
  boost::asio::thread_pool pool;
};

DiskThreads::DiskThreads(int threads) : impl_(std::make_unique<Impl>(threads)) {}

DiskThreads::~DiskThreads() { impl_->pool.join(); }

void DiskThreads::post(std::function<void()> work) {
  boost::asio::post(impl_->pool, std::move(work));
}

}  // namespace tet
