// How much memory a stretch of work took at its peak.
#pragma once

namespace tet::bench {

/// Peak resident memory of this process since construction, above what it held then. Linux
/// only.
class PeakMemory {
 public:
  PeakMemory();
  double peak_bytes() const;

 private:
  double before_;  // bytes
};

}  // namespace tet::bench
