// tetstreamd: reads its settings, serves until a signal, drains, exits.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <pthread.h>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

#include "core/base/bare_option.h"
#include "core/base/parallel.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/posix/printed.h"
#include "core/base/printable.h"
#include "core/manual/write_manual.h"
#include "proto/wire/transport.h"
#include "server/ops/config.h"
#include "server/ops/last_resort.h"
#include "server/ops/logging.h"
#include "server/rpc/grpc_log.h"
#include "server/rpc/token_file.h"
#include "server/server.h"
#include "server/upkeep/upkeep_commands.h"
#include "server/worker_process.h"

namespace {

constexpr std::chrono::seconds kLastWords{1};

enum ExitCode { kDone = 0, kRefused = 1, kUsage = 2, kFailed = 3 };

constexpr char kAbout[] =
    "Meshes OpenVDB grids and streams the tetrahedra over gRPC.\n\n"
    "A setting is taken from its flag, else from its TETSTREAM_* variable, else from the\n"
    "config file, else its default; --print-config shows the outcome, as a config file.\n\n"
    "  tetstreamd --store /var/lib/tetstream --store-bytes 200GiB\n"
    "  TETSTREAM_THREADS=8 tetstreamd --config /etc/tetstream.toml --print-config\n\n"
    "`tetstreamd worker` serves nobody: it does batch jobs for the servers whose --store and\n"
    "--jobs it is given. `backup`, `restore` and `check` take care of a store.\n\n"
    "SIGTERM makes health say that the server ends, for --lame-duck-seconds; then, and at once "
    "on\n"
    "SIGINT, running calls may finish for --drain-seconds. Exit codes: 0 done, 1 a setting "
    "was\n"
    "refused, 2 usage, 3 the server could not start.";

struct CommandLine {
  std::map<std::string, std::string> given;  ///< by setting key
  std::string config_file;
  bool print_config = false;
  bool worker = false;
  std::optional<tet::Upkeep> upkeep;
  std::string folder;  ///< of the backup
  std::string new_token;
};

/// A worker answers no calls.
bool concerns_worker(std::string_view key) {
  constexpr std::array<std::string_view, 16> kKeys{"memory",
                                                   "store",
                                                   "resident_bytes",
                                                   "plan_bytes",
                                                   "decoder",
                                                   "decoders",
                                                   "decode_seconds",
                                                   "threads",
                                                   "jobs",
                                                   "result_bytes",
                                                   "disk_reserve_bytes",
                                                   "grace_seconds",
                                                   "log_level",
                                                   "log_buffer_bytes",
                                                   "metrics_listen",
                                                   "max_tets"};
  return key.starts_with("job_") || std::ranges::find(kKeys, key) != kKeys.end();
}

void declare_setting(CLI::App& app, const tet::Setting& setting, CommandLine& line) {
  const std::string key = setting.key;
  app.add_option_function<std::string>(
      setting.flag(), [&line, key](const std::string& text) { line.given[key] = text; },
      absl::StrCat(setting.help, " [", setting.environment(), "]"));
}

void declare_worker(CLI::App& app, CommandLine& line) {
  CLI::App* const worker =
      app.add_subcommand("worker", "do batch jobs for servers that share --store and --jobs");
  worker->fallthrough()->callback([&line] { line.worker = true; });
  worker->footer(
      "The same settings may stand in a file (--config) or the environment. Those of "
      "tetstreamd "
      "that are not listed\nhere are about calls; a worker, which answers none, ignores them.");
  for (const tet::Setting& setting : tet::settings()) {
    if (concerns_worker(setting.key)) declare_setting(*worker, setting, line);
  }
}

void declare_upkeep(CLI::App& app, CommandLine& line) {
  const auto add = [&](const char* name, const char* help, tet::Upkeep what) {
    CLI::App* const command = app.add_subcommand(name, help);
    command->fallthrough()->callback([&line, what] { line.upkeep = what; });
    for (const tet::Setting& setting : tet::settings()) {
      const std::string_view key = setting.key;
      if (key == "store" || key == "jobs") declare_setting(*command, setting, line);
    }
    if (what == tet::Upkeep::kCheck) return;
    command->add_option("folder", line.folder, "folder of the backup")->required();
  };
  add("backup", "back the store up, or bring its backup up to date; servers may go on",
      tet::Upkeep::kBackup);
  add("restore", "make an empty store what a backup has", tet::Upkeep::kRestore);
  add("check", "read all of a store, and say what is damaged (exit code 1)",
      tet::Upkeep::kCheck);
}

void declare_options(CLI::App& app, CommandLine& line) {
  app.set_version_flag("--version", "tetstreamd " TETSTREAM_VERSION);
  tet::add_manual_option(app, "8", "tetstream " TETSTREAM_VERSION);
  app.add_option("--config", line.config_file, "TOML file of settings (keys as --print-config)")
      ->envname("TETSTREAM_CONFIG");
  declare_worker(app, line);
  declare_upkeep(app, line);
  app.add_flag("--print-config", line.print_config, "print the settings as TOML and exit");
  app.add_option("--new-token", line.new_token,
                 "make a token for NAME: print it to stderr, its entry of --tokens to stdout")
      ->type_name("NAME");
  for (const tet::Setting& setting : tet::settings()) declare_setting(app, setting, line);
}

absl::Status read_settings(const CommandLine& line, tet::Config& config) {
  if (!line.config_file.empty()) {
    if (auto status = tet::set_from_file(config, line.config_file); !status.ok()) return status;
  }
  if (auto status = tet::set_from_environment(config); !status.ok()) return status;
  for (const tet::Setting& setting : tet::settings()) {
    const auto given = line.given.find(setting.key);
    if (given == line.given.end()) continue;
    if (auto status = tet::set_from_text(config, setting, given->second); !status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(setting.flag(), ": ", status.message()));
    }
  }
  return absl::OkStatus();
}

/// Blocks the signals that end the server, in this thread and all it starts, and returns their
/// set.
sigset_t hold_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// Tells whoever started the server with port 0 where it listens; appears whole or not at all.
absl::Status write_port(const std::string& path, int port) {
  if (path.empty()) return absl::OkStatus();
  return tet::write_text_file(path, absl::StrCat(port, "\n"));
}

/// Takes as many files and connections as the system lets us have: gRPC does not survive a lack
/// of them.
void raise_file_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

int cannot_start(const absl::Status& status) {
  tet::log_event(spdlog::level::err, "cannot_start",
                 {{"message", std::string(status.message())}});
  return absl::IsInvalidArgument(status) ? kRefused : kFailed;
}

int print_new_token(const std::string& name) {
  const absl::StatusOr<tet::NewToken> token = tet::make_token(name);
  if (!token.ok()) {
    std::cerr << "tetstreamd: " << tet::for_terminal(std::string(token.status().message()))
              << "\n";
    return kRefused;
  }
  std::cerr << "This is the token; it is shown once. The rest is for the file of --tokens.\n"
            << token->text << "\n";
  std::cout << token->entry;
  return kDone;
}

/// Says that the server will end, and goes on: whoever balances the load hears of it before
/// anything is refused. Somebody at a terminal, who sends SIGINT, need not wait for that.
void go_lame(tet::Server& server, std::chrono::seconds time) {
  server.announce_end();
  tet::log_event(spdlog::level::info, "lame_duck", {{"seconds", time.count()}});
  std::this_thread::sleep_for(time);
}

int serve(const tet::Config& config, const sigset_t& signals) {
  tet::keep_grpc();
  tet::keep_read_blocks();
  raise_file_limit();
  tet::log_grpc_messages();
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit is an error like a full disk
  tet::ignore_hangups();
  // A server that was killed may have left its file: whoever waits for ours must not read that.
  if (!config.port_file.empty()) std::remove(config.port_file.c_str());
  auto server = tet::Server::start(config);
  if (!server.ok()) return cannot_start(server.status());
  // Before the event: whoever reads that finds the port.
  const absl::Status told = write_port(config.port_file, (*server)->port());
  if (!told.ok()) return cannot_start(told);
  tet::log_event(spdlog::level::info, "serving",
                 {{"address", (*server)->address()},
                  {"unix", (*server)->unix_address()},
                  {"metrics", (*server)->metrics_address()},
                  {"http", (*server)->http_address()},
                  {"version", TETSTREAM_VERSION}});
  int signal = 0;
  sigwait(&signals, &signal);
  const std::chrono::seconds lame_duck(
      signal == SIGTERM && !tet::stopped_listening() ? config.lame_duck_seconds : 0);
  const std::chrono::seconds drain(config.drain_seconds);
  const std::chrono::seconds grace(config.grace_seconds);
  tet::end_after(lame_duck + drain + grace, signals);
  if (lame_duck.count() > 0) go_lame(**server, lame_duck);
  tet::log_event(spdlog::level::info, "draining", {{"signal", signal}});
  (*server)->stop(drain);
  tet::log_event(spdlog::level::info, "stopped");
  return tet::stopped_listening() ? kFailed : kDone;
}

/// The signal that ends a worker; 0 if that is that there is nothing to do.
int wait_for_end(const sigset_t& signals, tet::WorkerProcess& worker) {
  constexpr timespec kSecond{1, 0};
  while (!worker.is_idle()) {
    const int signal = ::sigtimedwait(&signals, nullptr, &kSecond);
    if (signal > 0) return signal;
  }
  return 0;
}

int work(const tet::Config& config, const sigset_t& signals) {
  raise_file_limit();
  std::signal(SIGXFSZ, SIG_IGN);
  tet::ignore_hangups();
  auto worker = tet::WorkerProcess::start(config);
  if (!worker.ok()) return cannot_start(worker.status());
  tet::log_event(spdlog::level::info, "working",
                 {{"metrics", (*worker)->metrics_address()}, {"version", TETSTREAM_VERSION}});
  tet::log_event(spdlog::level::info, "draining",
                 {{"signal", wait_for_end(signals, **worker)}});
  tet::end_after(std::chrono::seconds(config.grace_seconds), signals);
  worker->reset();
  tet::log_event(spdlog::level::info, "stopped");
  return kDone;
}

int run_command_line(int argc, char** argv) {
  CLI::App app(kAbout, "tetstreamd");
  CommandLine line;
  declare_options(app, line);
  try {
    const std::string bare = tet::option_without_value({argv + std::min(argc, 1), argv + argc});
    if (!bare.empty()) {
      throw CLI::ValidationError(
          absl::StrCat(bare, " has nothing behind its =: give it a value, write ", bare,
                       " \"\" where that is to be empty, or leave it out"));
    }
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  if (!line.new_token.empty()) return print_new_token(line.new_token);
  tet::Config config;
  if (const absl::Status status = read_settings(line, config); !status.ok()) {
    std::cerr << "tetstreamd: " << tet::for_terminal(std::string(status.message())) << "\n";
    return kRefused;
  }
  if (line.print_config) {
    std::cout << tet::to_toml(config, tet::Secrets::kHidden);
    return kDone;
  }
  if (line.upkeep) return tet::run_upkeep(*line.upkeep, config, line.folder);
  // Before the first thread, which is the log's: a thread that does not block them would be
  // killed by the second, and the process with it.
  const sigset_t signals = hold_signals();
  tet::start_logging(config.log_level, config.log_buffer_bytes);
  const int code = line.worker ? work(config, signals) : serve(config, signals);
  tet::flush_log(kLastWords);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  const tet::WorkerThreads workers;
  return tet::exit_code_of_printed(run_command_line(argc, argv), "tetstreamd");
}
