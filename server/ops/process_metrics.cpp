#include "server/ops/process_metrics.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

/// Fields of /proc/self/stat from the third on, as proc(5) numbers them: the name before them
/// may hold anything.
class ProcessStat {
 public:
  ProcessStat() {
    std::string line;
    std::getline(std::ifstream("/proc/self/stat"), line);
    std::istringstream rest(line.substr(line.rfind(')') + 1));
    std::string state;
    rest >> state;
    for (double field = 0; rest >> field;) fields_.push_back(field);
  }
  double operator[](std::size_t number) const {
    return number - 4 < fields_.size() ? fields_[number - 4] : 0;
  }

 private:
  std::vector<double> fields_;
};

double boot_time() {
  std::ifstream stat("/proc/stat");
  for (std::string word; stat >> word;) {
    double seconds = 0;
    if (word == "btime" && stat >> seconds) return seconds;
  }
  return 0;
}

double open_files() {
  std::error_code error;
  const std::filesystem::directory_iterator files("/proc/self/fd", error);
  return error ? 0 : static_cast<double>(std::distance(begin(files), end(files)));
}

double file_limit() {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  return static_cast<double>(limit.rlim_cur);
}

}  // namespace

std::vector<Reading> read_process() {
  const ProcessStat stat;
  const auto ticks = static_cast<double>(::sysconf(_SC_CLK_TCK));
  const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  return {counter("process_cpu_seconds_total", "User and system time.",
                  (stat[14] + stat[15]) / ticks),
          gauge("process_threads", "Threads.", stat[20]),
          gauge("process_start_time_seconds", "When it started, seconds since 1970.",
                boot_time() + stat[22] / ticks),
          gauge("process_virtual_memory_bytes", "Addresses in use.", stat[23]),
          gauge("process_resident_memory_bytes", "Memory in use.", stat[24] * page),
          gauge("process_open_fds", "Open file descriptors.", open_files()),
          gauge("process_max_fds", "File descriptors there may be.", file_limit()),
          counter("tetstream_log_dropped_lines_total", "Log lines that nobody read in time.",
                  dropped_log_lines())};
}

}  // namespace tet
