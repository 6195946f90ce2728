// Puts many broken .vdb files through a server of its own, as several clients at once.
//
//   service_campaign [--mutants N] [--first I] [--seed S] [--clients C] [--files DIR]
//                    [--folder DIR] [--server PROGRAM] [--max-seconds S] [--max-bytes B]
//
// Each file is uploaded, looked into and meshed. Fails with exit code 1 when one was neither
// meshed nor refused as hostile files are, when a trial took the server and its decoders more
// than --max-seconds of processors (those that were slow beside others, or had no answer in
// time, are tried again alone, and count as that), when the server had more memory than
// --max-bytes, when it died, or when it no longer meshes a good file.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>

#include "tests/hostile/campaign.h"
#include "tests/hostile/seed_files.h"
#include "tests/hostile/server_process.h"
#include "tests/hostile/service_trial.h"

namespace {

using namespace tet::test;

struct Options {
  std::uint64_t mutants = 1000, first = 0, seed = 1, clients = 4;
  std::string files;
  std::string folder = std::filesystem::temp_directory_path() / "service_campaign";
  std::string server = TETSTREAMD_PATH;
  double max_seconds = 2;
  std::uint64_t max_bytes = std::uint64_t{1} << 30;
};

/// A small server's. A few kilobytes of tiles may claim a solid with more surface than a
/// minute's counting: what a plan may hold also bounds the work for it.
const std::vector<std::string> kSettings{"--store-bytes", "256MiB",       "--resident-bytes",
                                         "256MiB",        "--plan-bytes", "128MiB"};

constexpr std::uint64_t kToldEach = 10'000;

/// Beside others a file waits for them, and for whatever else the machine does: it is judged
/// when it has been tried again alone.
constexpr std::chrono::seconds kPatienceBesideOthers{60};

/// Mutants [first, first + mutants), shared out to clients.
CampaignResult attack(const Mutator& mutator,
                      const Options& options,
                      const ServerProcess& server) {
  CampaignResult total;
  std::mutex mutex;
  std::atomic<std::uint64_t> done = 0;
  std::vector<std::jthread> clients;
  for (std::uint64_t c = 0; c < options.clients; ++c) {
    const std::uint64_t begin = options.mutants * c / options.clients;
    const std::uint64_t end = options.mutants * (c + 1) / options.clients;
    clients.emplace_back([&, begin, end] {
      ServiceTrial service(server.address(), kPatienceBesideOthers);
      std::ostringstream log;
      const CampaignResult result = run_campaign(
          mutator, {options.first + begin, end - begin},
          {[&](const Mutant& mutant) {
             if (const auto now = ++done; now % kToldEach == 0) std::cout << now << std::endl;
             return service.run(mutant.bytes);
           },
           [&] { return server.processor_seconds(); }},
          [](std::uint64_t, const Mutant&) {}, log);
      const std::lock_guard lock(mutex);
      total.add(result);
      std::cout << log.str();
    });
  }
  clients.clear();
  return total;
}

/// One after the other, with the server for themselves.
CampaignResult attack_alone(const Mutator& mutator,
                            const std::vector<std::uint64_t>& mutants,
                            const ServerProcess& server) {
  ServiceTrial service(server.address());
  CampaignResult total;
  for (const std::uint64_t i : mutants) {
    total.add(run_trial(i, mutator.mutant(i),
                        {[&](const Mutant& mutant) { return service.run(mutant.bytes); },
                         [&] { return server.processor_seconds(); }},
                        std::cout));
  }
  std::cout << absl::StrFormat(
      "%10d  of them took longer than %g s of processors, or had no answer; alone the slowest "
      "took %.3f ms "
      "(mutant %d)\n",
      total.mutants, kSlowSeconds, total.slowest_seconds * 1e3, total.slowest);
  return total;
}

/// All of them at once, then the slow ones again.
CampaignResult attack_with_mutants(const Options& options, const ServerProcess& server) {
  const Mutator mutator(seed_files(), options.seed);
  CampaignResult result = attack(mutator, options, server);
  print_result(result, std::cout);
  const CampaignResult alone = attack_alone(mutator, result.slow, server);
  result.unexpected += alone.unexpected - result.unanswered;
  if (alone.mutants > 0) result.slowest_seconds = alone.slowest_seconds;
  return result;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Every file of a folder, one after the other, each with its outcome.
CampaignResult attack_with_files(const std::string& folder, const ServerProcess& server) {
  std::vector<SeedFile> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".vdb") continue;
    files.push_back({entry.path().filename(), read_file(entry.path()), {}, {}});
  }
  std::ranges::sort(files, {}, &SeedFile::name);
  ServiceTrial service(server.address());
  CampaignResult total;
  for (const SeedFile& file : files) {
    const auto attempt = [&] {
      return run_trial(total.mutants, {file.bytes, true, file.name},
                       {[&](const Mutant& mutant) {
                          const absl::Status status = service.run(mutant.bytes);
                          std::cout << file.name << ": " << status << '\n';
                          return status;
                        },
                        [&] { return server.processor_seconds(); }},
                       std::cout);
    };
    CampaignResult one = attempt();
    if (!one.slow.empty()) one = attempt();  // what else the machine did may have made it so
    total.add(one);
  }
  print_result(total, std::cout);
  return total;
}

int verdict(const CampaignResult& result, const Options& options, ServerProcess& server) {
  const bool alive = server.alive();
  const std::uint64_t peak = alive ? server.peak_resident_bytes() : 0;
  const bool well = alive && ServiceTrial(server.address()).run(seed_files()[0].bytes).ok();
  const bool stopped = alive && server.stop();
  std::cout << absl::StrFormat("%10.1f  MiB of memory at most\n",
                               static_cast<double>(peak) / (1 << 20));
  const auto expect = [](bool held, const char* claim) {
    if (!held) std::cout << "FAILED: " << claim << '\n';
    return held;
  };
  bool held = expect(result.unexpected == 0, "every file was meshed or refused");
  held &= expect(result.slowest_seconds <= options.max_seconds, "no trial took too long");
  held &= expect(alive, "the server lives");
  held &= expect(peak <= options.max_bytes, "its memory stayed within the limit");
  held &= expect(well, "it meshes a good file afterwards");
  held &= expect(stopped, "it stops when it is told to");
  return held ? 0 : 1;
}

int run(const Options& options) {
  auto server = ServerProcess::start(options.server, options.folder, kSettings);
  if (!server.ok()) {
    std::cerr << "service_campaign: " << server.status().message() << '\n';
    return 1;
  }
  const CampaignResult result = options.files.empty()
                                    ? attack_with_mutants(options, *server)
                                    : attack_with_files(options.files, *server);
  const int code = verdict(result, options, *server);
  if (code == 0) std::filesystem::remove_all(options.folder);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Puts mutants of .vdb files through a server");
  app.add_option("--mutants", options.mutants, "how many");
  app.add_option("--first", options.first, "the first one's number");
  app.add_option("--seed", options.seed, "the campaign's number");
  app.add_option("--clients", options.clients, "how many at once")->check(CLI::PositiveNumber);
  app.add_option("--files", options.files, "the .vdb files of this folder instead of mutants")
      ->check(CLI::ExistingDirectory);
  app.add_option("--folder", options.folder,
                 "for the server's store and log; gone if all is well");
  app.add_option("--server", options.server, "the tetstreamd to attack")
      ->check(CLI::ExistingFile);
  app.add_option("--max-seconds", options.max_seconds, "of processors for one file");
  app.add_option("--max-bytes", options.max_bytes, "of the server's memory")
      ->transform(CLI::AsSizeValue(false));
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
