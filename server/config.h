// Settings of tetstreamd: flags before environment before file before defaults.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include <absl/status/status.h>

namespace tet {

struct Config {
  std::string listen = "127.0.0.1:7447";
  std::string tls_cert;
  std::string tls_key;
  std::string tls_client_ca;
  std::string tokens;
  std::string reflection = "auto";
  std::string store = "tetstream-store";
  std::uint64_t store_bytes = std::uint64_t{64} << 30;
  std::uint64_t resident_bytes = std::uint64_t{4} << 30;
  std::string decoder;
  std::uint64_t decoders = 0;
  std::uint64_t decode_seconds = 120;
  std::uint64_t threads = 0;
  std::uint64_t max_streams = 64;
  std::uint64_t max_tets = 4'000'000'000;
  std::uint64_t max_request_bytes = std::uint64_t{4} << 20;
  std::uint64_t drain_seconds = 30;
  std::string log_level = "info";
  std::string metrics_listen;
  std::string port_file;
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

/// Sets what the TETSTREAM_* variables say. Errors: kInvalidArgument, naming the variable.
absl::Status set_from_environment(Config& config);

/// The whole config as a TOML file that set_from_file reads back.
std::string to_toml(const Config& config);

}  // namespace tet
