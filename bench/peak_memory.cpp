#include "bench/peak_memory.h"

#include <algorithm>
#include <fstream>
#include <malloc.h>
#include <string>

namespace tet::bench {
namespace {

/// A field of /proc/self/status, which is in kB; 0 where there is none.
double status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == field && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);  // what is free but kept would hide the next use of it
  std::ofstream("/proc/self/clear_refs") << 5;  // 5: forget the peak
  before_ = status_bytes("VmRSS:");
}

double PeakMemory::peak_bytes() const {
  return std::max(0.0, status_bytes("VmHWM:") - before_);
}

}  // namespace tet::bench
