// What a server asks itself: whether its store and its decoder are there.
#pragma once

#include <vector>

#include "server/ops/config.h"
#include "server/ops/metrics.h"
#include "server/ops/probe.h"

namespace tet {

/// Looks every few seconds. Thread-safe; no member waits but the destructor.
class ServerProbes {
 public:
  explicit ServerProbes(const Config& config);

  /// Whether meshes can be made.
  bool works() const { return store_.status().ok() && decoder_.status().ok(); }
  std::vector<Reading> readings() const;

 private:
  Probe store_, decoder_;
};

}  // namespace tet
