// A mesh that comes in chunks, as Python holds it.
#pragma once

#include <atomic>
#include <optional>

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
  /// A tuple of the next chunk, with arrays of its own; None after the last.
  py::object next();
  py::dict statistics();
  void close();

 private:
  void begin();
  void end();
  /// Raises where there is nothing to be read any more.
  void check_open() const;

  Watch watch_;
  std::optional<MeshStream> stream_;  ///< nothing once it is closed
  std::optional<MeshHeader> header_;
  std::atomic<bool> closed_{false};
  std::atomic<bool> busy_{false};  ///< a thread is in one of the members
};

}  // namespace tetstream::python
