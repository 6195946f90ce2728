#include "server/ops/logging.h"

#include <atomic>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <absl/time/clock.h>
#include <absl/time/time.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include "server/ops/log_writer.h"

namespace tet {

namespace {

std::atomic<LogWriter*> log_writer{nullptr};  ///< null before start_logging: tests print

/// Which file stderr is. One that cannot be asked is like every other such.
std::pair<dev_t, ino_t> file_of_stderr() {
  struct stat file {};
  return ::fstat(STDERR_FILENO, &file) == 0 ? std::pair(file.st_dev, file.st_ino)
                                            : std::pair<dev_t, ino_t>();
}

}  // namespace

void start_logging(const std::string& level, std::size_t buffer_bytes) {
  // spdlog decides about levels; what it writes with would wait for whoever reads.
  auto logger = std::make_shared<spdlog::logger>(
      "tetstream", std::make_shared<spdlog::sinks::null_sink_mt>());
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
  static std::pair<dev_t, ino_t> written_to;
  if (log_writer != nullptr && file_of_stderr() == written_to) return;
  written_to = file_of_stderr();
  log_writer = &LogWriter::start(STDERR_FILENO, buffer_bytes);
}

void log_event(spdlog::level::level_enum level,
               std::string_view event,
               const nlohmann::ordered_json& fields) {
  if (!spdlog::should_log(level)) return;
  nlohmann::ordered_json line;
  line["time"] = absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::Now(), absl::UTCTimeZone());
  line["level"] = std::string_view(spdlog::level::to_string_view(level).data());
  line["event"] = event;
  line.update(fields);
  // A client's text may not be UTF-8; a log line must be all the same.
  std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (LogWriter* const writer = log_writer) {
    writer->write(std::move(text) + "\n");
  } else {
    spdlog::log(level, "{}", text);
  }
}

void flush_log(std::chrono::milliseconds timeout) {
  if (LogWriter* const writer = log_writer) writer->flush(timeout);
}

std::int64_t dropped_log_lines() {
  LogWriter* const writer = log_writer;
  return writer == nullptr ? 0 : writer->dropped_lines();
}

}  // namespace tet
