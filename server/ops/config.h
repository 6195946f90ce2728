// Settings of tetstreamd: flags before environment before file before defaults.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include <absl/status/status.h>

namespace tet {

/// TOML's own integers end here.
inline constexpr std::uint64_t kMaxSetting = std::numeric_limits<std::int64_t>::max();

struct Config {
  std::string listen = "127.0.0.1:7447";
  std::string listen_unix;
  std::string listen_unix_mode = "600";
  std::string shared_memory = "on";
  std::string tls_cert;
  std::string tls_key;
  std::string tls_client_ca;
  std::string tokens;
  std::string reflection = "auto";
  std::string store = "tetstream-store";
  std::uint64_t store_bytes = std::uint64_t{64} << 30;
  std::uint64_t memory = 0;          ///< 0: see divide_memory
  std::uint64_t resident_bytes = 0;  ///< likewise
  std::uint64_t plan_bytes = 0;      ///< likewise
  std::uint64_t plan_seconds = 600;
  std::string decoder;
  std::uint64_t decoders = 0;
  std::uint64_t decode_seconds = 120;
  std::uint64_t threads = 0;
  std::string jobs;
  std::uint64_t job_workers = 2;
  std::uint64_t job_lease_seconds = 30;
  std::uint64_t job_idle_seconds = 0;
  std::uint64_t job_count_bricks = 32'768;
  std::uint64_t job_keep_hours = 168;
  std::uint64_t max_namespace_jobs = 100'000;
  std::uint64_t result_bytes = std::uint64_t{64} << 30;
  std::uint64_t disk_reserve_bytes = std::uint64_t{64} << 20;
  std::uint64_t max_streams = 64;
  std::uint64_t max_tets = 4'000'000'000;
  std::uint64_t max_request_bytes = std::uint64_t{4} << 20;
  std::uint64_t max_client_streams = 32;
  std::uint64_t max_queued = 256;
  std::uint64_t max_client_queued = 64;
  std::uint64_t queue_seconds = 10;
  std::uint64_t max_uploads = 64;
  std::uint64_t max_client_uploads = 16;
  std::uint64_t max_client_upload_bytes = std::uint64_t{16} << 30;
  std::uint64_t send_bytes = std::uint64_t{128} << 20;
  std::uint64_t receive_bytes = std::uint64_t{128} << 20;
  std::uint64_t receive_window_bytes = std::uint64_t{1} << 20;
  std::uint64_t stall_seconds = 60;
  std::uint64_t session_idle_seconds = 600;
  std::uint64_t keepalive_seconds = 20;
  std::uint64_t handshake_seconds = 10;
  std::uint64_t max_connection_streams = 256;
  std::uint64_t max_metadata_bytes = std::uint64_t{16} << 10;
  std::uint64_t connection_idle_seconds = 600;
  std::uint64_t connection_age_seconds = 3600;
  std::uint64_t connection_grace_seconds = 3600;
  std::uint64_t max_calls = 4096;
  std::uint64_t max_client_calls = 1024;
  std::uint64_t max_client_watches = 64;
  std::uint64_t max_health_watches = 1024;
  std::uint64_t max_client_health_watches = 64;
  std::uint64_t lame_duck_seconds = 5;
  std::uint64_t drain_seconds = 30;
  std::uint64_t grace_seconds = 10;
  std::string log_level = "info";
  std::uint64_t log_buffer_bytes = std::uint64_t{4} << 20;
  std::string metrics_listen;
  std::string http_listen;
  std::string http_origins;
  std::string http_page;
  std::uint64_t max_http_connections = 1024;
  std::string port_file;

  bool has_jobs() const { return jobs != "off"; }
};

/// One setting. Its key is `store_bytes` in a file, `--store-bytes` as a flag and
/// `TETSTREAM_STORE_BYTES` in the environment.
struct Setting {
  const char* key;
  const char* help;
  std::variant<std::string Config::*, std::uint64_t Config::*> field;
  std::uint64_t min = 0;
  std::uint64_t max = 0;

  std::string flag() const;
  std::string environment() const;
};

/// Every setting there is, in the order they are printed.
std::span<const Setting> settings();

/// Sets one setting from text. Numbers may end in KiB, MiB, GiB or TiB.
/// Errors: kInvalidArgument, naming the key, the value and what it may be.
absl::Status set_from_text(Config& config, const Setting& setting, std::string_view text);

/// Sets what a TOML file says.
/// Errors: kInvalidArgument (not TOML, unknown key, wrong value; named), kNotFound (no such
/// file).
absl::Status set_from_file(Config& config, const std::string& path);

/// Sets what the TETSTREAM_* variables say. Errors: kInvalidArgument, naming the variable: a
/// wrong value, or one that is no setting's.
absl::Status set_from_environment(Config& config);

enum class Secrets { kShown, kHidden };

/// The whole config as a TOML file that set_from_file reads back; of addresses without their
/// passwords, if these are hidden.
std::string to_toml(const Config& config, Secrets secrets = Secrets::kShown);

}  // namespace tet
