// The few threads that wait for the disk, so that neither gRPC's nor the mesher's do.
#pragma once

#include <functional>
#include <memory>

namespace tet {

/// Runs what is posted, first come, first served. Thread safety: any thread may post. The
/// destructor waits for all that was posted.
class DiskThreads {
 public:
  explicit DiskThreads(int threads);
  ~DiskThreads();
  DiskThreads(const DiskThreads&) = delete;
  DiskThreads& operator=(const DiskThreads&) = delete;

  void post(std::function<void()> work);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tet
