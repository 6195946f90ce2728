#include "server/ops/config.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <toml++/toml.h>

namespace tet {

namespace {

// Clients upload in pieces of a megabyte.
constexpr std::uint64_t kMinMessage = std::uint64_t{2} << 20;
constexpr std::uint64_t kMaxMessage = std::uint64_t{1} << 30;
constexpr std::uint64_t kMinReceive = std::uint64_t{16} << 20;
// What HTTP/2 begins with.
constexpr std::uint64_t kMinWindow = (std::uint64_t{1} << 16) - 1;
// gRPC counts milliseconds in an int.
constexpr std::uint64_t kMaxSeconds = 2'000'000;
// TOML's own integers end here.
constexpr std::uint64_t kMaxBytes = std::numeric_limits<std::int64_t>::max();

Setting text(std::string Config::*field, const char* key, const char* help) {
  return {key, help, field};
}

Setting number(std::uint64_t Config::*field,
               std::uint64_t min,
               std::uint64_t max,
               const char* key,
               const char* help) {
  return {key, help, field, min, max};
}

const Setting kSettings[] = {
    text(&Config::listen, "listen", "host:port to serve on; port 0 takes a free one"),
    text(&Config::tls_cert, "tls_cert", "PEM file of the certificate chain; turns TLS on"),
    text(&Config::tls_key, "tls_key", "PEM file of its private key"),
    text(&Config::tls_client_ca, "tls_client_ca", "PEM file; clients need a certificate of it"),
    text(&Config::tokens, "tokens", "TOML file of who may call; turns bearer tokens on"),
    text(&Config::reflection, "reflection", "on, off, or auto: unless there are tokens"),
    text(&Config::store, "store", "directory of the stored grid files; made when missing"),
    number(&Config::store_bytes,
           1,
           kMaxBytes,
           "store_bytes",
           "disk for grid files; the least used are evicted"),
    number(&Config::resident_bytes,
           1,
           kMaxBytes,
           "resident_bytes",
           "memory for grids ready to mesh"),
    number(&Config::plan_bytes,
           1,
           kMaxBytes,
           "plan_bytes",
           "memory for counted meshes; more are told to retry"),
    text(&Config::decoder, "decoder", "program that reads grid files; empty finds it"),
    number(&Config::decoders, 0, 1024, "decoders", "files decoded at once; 0: one a core"),
    number(&Config::decode_seconds,
           1,
           86'400,
           "decode_seconds",
           "the longest that decoding one file may take"),
    number(&Config::threads, 0, 4096, "threads", "meshing threads; 0 takes every core"),
    text(&Config::jobs,
         "jobs",
         "file of the batch jobs, a postgresql:// address, or off; empty: in the store"),
    number(&Config::job_workers, 0, 1024, "job_workers", "threads that do jobs; 0: none here"),
    number(&Config::job_lease_seconds,
           1,
           86'400,
           "job_lease_seconds",
           "a worker not heard of for so long has died"),
    number(&Config::job_idle_seconds,
           0,
           86'400,
           "job_idle_seconds",
           "a worker ends when there was no job for so long; 0: never"),
    number(&Config::job_count_bricks,
           64,
           1 << 23,
           "job_count_bricks",
           "bricks near the surface that one shard counts, of a mesh with twice as many"),
    number(&Config::job_keep_hours,
           1,
           1'000'000,
           "job_keep_hours",
           "how long finished jobs are kept"),
    number(&Config::max_namespace_jobs,
           1,
           kMaxBytes,
           "max_namespace_jobs",
           "jobs of one namespace that are not finished"),
    number(&Config::result_bytes,
           1,
           kMaxBytes,
           "result_bytes",
           "disk for meshes of jobs; the least used are evicted"),
    number(&Config::disk_reserve_bytes,
           0,
           kMaxBytes,
           "disk_reserve_bytes",
           "disk that grids and meshes leave free, for the jobs' database"),
    number(&Config::max_streams,
           1,
           100'000,
           "max_streams",
           "meshes made at once; more are told to retry"),
    number(&Config::max_tets, 1, kMaxBytes, "max_tets", "tets of one mesh"),
    number(&Config::max_request_bytes,
           kMinMessage,
           kMaxMessage,
           "max_request_bytes",
           "one message from a client"),
    number(&Config::max_client_streams,
           1,
           100'000,
           "max_client_streams",
           "meshes made at once for one client"),
    number(&Config::max_queued,
           0,
           100'000,
           "max_queued",
           "meshes that may wait for their turn; 0 refuses at once"),
    number(&Config::max_client_queued,
           0,
           100'000,
           "max_client_queued",
           "meshes of one client that may wait"),
    number(&Config::queue_seconds,
           1,
           86'400,
           "queue_seconds",
           "how long a mesh may wait for its turn"),
    number(&Config::max_uploads, 1, 100'000, "max_uploads", "uploads at once"),
    number(&Config::max_client_uploads,
           1,
           100'000,
           "max_client_uploads",
           "uploads of one client at once"),
    number(&Config::max_client_upload_bytes,
           1,
           kMaxBytes,
           "max_client_upload_bytes",
           "disk for unfinished uploads of one client"),
    number(&Config::send_bytes,
           kMinMessage,
           kMaxBytes,
           "send_bytes",
           "memory for chunks on their way to clients"),
    number(&Config::receive_bytes,
           kMinReceive,
           kMaxBytes,
           "receive_bytes",
           "memory for what comes from clients"),
    number(&Config::receive_window_bytes,
           kMinWindow,
           kMaxMessage,
           "receive_window_bytes",
           "what a client may send ahead of being read"),
    number(&Config::stall_seconds,
           1,
           86'400,
           "stall_seconds",
           "how long a client may neither take nor send anything"),
    number(&Config::session_idle_seconds,
           1,
           86'400,
           "session_idle_seconds",
           "how long a session may wait for its next frame"),
    number(&Config::keepalive_seconds,
           1,
           86'400,
           "keepalive_seconds",
           "silent connections are pinged so often"),
    number(&Config::max_connection_streams,
           1,
           100'000,
           "max_connection_streams",
           "calls on one connection at once"),
    number(&Config::max_metadata_bytes,
           1024,
           1 << 20,
           "max_metadata_bytes",
           "headers of one call"),
    number(&Config::connection_idle_seconds,
           1,
           kMaxSeconds,
           "connection_idle_seconds",
           "how long a connection may have no call"),
    number(&Config::connection_age_seconds,
           1,
           kMaxSeconds,
           "connection_age_seconds",
           "when a connection is to be made again"),
    number(&Config::connection_grace_seconds,
           1,
           kMaxSeconds,
           "connection_grace_seconds",
           "how long its calls may then go on"),
    number(&Config::max_calls, 1, 1'000'000, "max_calls", "calls of all kinds at once"),
    number(&Config::max_client_calls,
           1,
           1'000'000,
           "max_client_calls",
           "calls of one client at once"),
    number(&Config::drain_seconds,
           0,
           86'400,
           "drain_seconds",
           "how long running calls may go on after SIGTERM"),
    text(&Config::log_level, "log_level", "trace, debug, info, warn, error or off"),
    text(&Config::metrics_listen,
         "metrics_listen",
         "host:port for metrics and health over HTTP; empty: none"),
    text(&Config::http_listen,
         "http_listen",
         "host:port for browsers and curl: the page, gRPC-Web, JSON; empty: none"),
    text(&Config::http_origins,
         "http_origins",
         "other origins whose pages may ask there, separated by commas"),
    text(&Config::http_page, "http_page", "folder of the page's files; empty finds it"),
    number(&Config::max_http_connections,
           8,
           100'000,
           "max_http_connections",
           "connections over HTTP at once"),
    text(&Config::port_file, "port_file", "write the chosen port to this file once serving"),
};

std::optional<std::uint64_t> parse_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  const std::string_view unit(end, text.size() - static_cast<std::size_t>(end - text.data()));
  constexpr std::string_view kUnits[] = {"", "KiB", "MiB", "GiB", "TiB"};
  const auto* found = std::find(std::begin(kUnits), std::end(kUnits), unit);
  if (found == std::end(kUnits)) return std::nullopt;
  const auto shift = 10 * (found - std::begin(kUnits));
  if (number > (kMaxBytes >> shift)) return std::nullopt;
  return number << shift;
}

/// The words that a text setting is one of; none where it may be any text.
std::vector<std::string> words_of(std::string_view key) {
  if (key == "log_level") return {"trace", "debug", "info", "warn", "error", "off"};
  if (key == "reflection") return {"auto", "on", "off"};
  return {};
}

absl::Status check_text(const Setting& setting, std::string_view text) {
  const std::vector<std::string> words = words_of(setting.key);
  if (words.empty() || std::find(words.begin(), words.end(), text) != words.end()) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat("%s \"%s\" is none of %s", setting.key,
                                                    text, absl::StrJoin(words, ", ")));
}

const Setting* find_setting(std::string_view key) {
  const auto* found = std::find_if(std::begin(kSettings), std::end(kSettings),
                                   [&](const Setting& s) { return s.key == key; });
  return found == std::end(kSettings) ? nullptr : found;
}

absl::Status set_from_toml(Config& config, std::string_view key, const toml::node& node) {
  const Setting* setting = find_setting(key);
  if (setting == nullptr) {
    return absl::InvalidArgumentError(absl::StrFormat("unknown key \"%s\"", key));
  }
  if (const auto* text = node.as_string()) return set_from_text(config, *setting, text->get());
  if (const auto* number = node.as_integer()) {
    return set_from_text(config, *setting, absl::StrCat(number->get()));
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("%s is neither text nor a whole number", key));
}

absl::Status prefixed(std::string_view prefix, const absl::Status& status) {
  return {status.code(), absl::StrFormat("%s: %s", prefix, status.message())};
}

}  // namespace

std::string Setting::flag() const { return "--" + absl::StrReplaceAll(key, {{"_", "-"}}); }

std::string Setting::environment() const { return "TETSTREAM_" + absl::AsciiStrToUpper(key); }

std::span<const Setting> settings() { return kSettings; }

absl::Status set_from_text(Config& config, const Setting& setting, std::string_view text) {
  if (const auto* field = std::get_if<std::string Config::*>(&setting.field)) {
    config.*(*field) = text;
    return check_text(setting, text);
  }
  const auto number = parse_number(text);
  if (!number || *number < setting.min || *number > setting.max) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s \"%s\" is not a number from %d to %d (KiB, MiB, GiB and TiB are understood)",
        setting.key, text, setting.min, setting.max));
  }
  config.*std::get<std::uint64_t Config::*>(setting.field) = *number;
  return absl::OkStatus();
}

absl::Status set_from_file(Config& config, const std::string& path) {
  try {
    const toml::table table = toml::parse_file(path);
    for (const auto& [key, node] : table) {
      const absl::Status status = set_from_toml(config, key.str(), node);
      if (!status.ok()) {
        return prefixed(absl::StrCat(path, ":", node.source().begin.line), status);
      }
    }
    return absl::OkStatus();
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    const std::string where = line == 0 ? path : absl::StrCat(path, ":", line);
    return absl::InvalidArgumentError(absl::StrFormat("%s: %s", where, error.description()));
  }
}

absl::Status set_from_environment(Config& config) {
  for (const Setting& setting : kSettings) {
    const std::string variable = setting.environment();
    const char* text = std::getenv(variable.c_str());
    if (text == nullptr) continue;
    const absl::Status status = set_from_text(config, setting, text);
    if (!status.ok()) return prefixed(variable, status);
  }
  return absl::OkStatus();
}

std::string to_toml(const Config& config) {
  std::string text;
  for (const Setting& setting : kSettings) {
    toml::table line;
    if (const auto* field = std::get_if<std::string Config::*>(&setting.field)) {
      line.insert(setting.key, config.*(*field));
    } else {
      const auto number = config.*std::get<std::uint64_t Config::*>(setting.field);
      line.insert(setting.key, static_cast<std::int64_t>(number));
    }
    std::ostringstream out;
    out << line;
    absl::StrAppend(&text, "# ", setting.help, "\n", out.str(), "\n");
  }
  return text;
}

}  // namespace tet
