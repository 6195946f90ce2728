// A mesh that comes in chunks, as Python holds it.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "client/python/extension/bindings.h"
#include "tetstream/stream.h"

namespace tetstream::python {

/// Begins when it is made, and has the mesh's header from then on.
class Stream {
 public:
  /// `make` gets the options and returns a MeshStream.
  template <class Function>
  Stream(const CallOptions& options, const Function& make)
      : watch_(options.watch()), stream_(make(options.connected(watch_))) {
    begin();
  }
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  const MeshHeader& header() const { return *header_; }
  /// Returns a tuple of the next chunk, whose arrays are the reader's; None after the last.
  /// Takes no other chunk from where it is made if it is to come `alone`.
  py::object next(bool alone);
  py::dict statistics();
  void close();

 private:
  /// A chunk that came, and what keeps its arrays.
  struct Came {
    Chunk chunk;
    std::shared_ptr<const void> memory;
  };

  void begin();
  void end();
  /// Waits for the next chunk, and takes some after it where they come as fast as they are
  /// handed from thread to thread.
  void read(std::size_t most);
  bool has_come() const { return given_ < came_.size(); }
  /// Raises where there is nothing to be read any more.
  void check_open() const;

  Watch watch_;
  std::optional<MeshStream> stream_;  ///< nothing once it is closed
  std::optional<MeshHeader> header_;
  std::vector<Came> came_;
  std::size_t given_ = 0;  ///< of those that came
  std::size_t ahead_ = 1;  ///< how many to read at once
  std::atomic<bool> closed_{false};
  std::atomic<bool> busy_{false};  ///< a thread is in one of the members
};

}  // namespace tetstream::python
