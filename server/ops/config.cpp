#include "server/ops/config.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <unistd.h>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <toml++/toml.h>

namespace tet {

namespace {

constexpr char kHidden[] = "***";

std::optional<std::uint64_t> parse_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  const std::string_view unit(end, text.size() - static_cast<std::size_t>(end - text.data()));
  constexpr std::string_view kUnits[] = {"", "KiB", "MiB", "GiB", "TiB"};
  const auto* found = std::find(std::begin(kUnits), std::end(kUnits), unit);
  if (found == std::end(kUnits)) return std::nullopt;
  const auto shift = 10 * (found - std::begin(kUnits));
  if (number > (kMaxSetting >> shift)) return std::nullopt;
  return number << shift;
}

/// The words that a text setting is one of; none where it may be any text.
std::vector<std::string> words_of(std::string_view key) {
  if (key == "log_level") return {"trace", "debug", "info", "warn", "error", "off"};
  if (key == "reflection") return {"auto", "on", "off"};
  if (key == "shared_memory") return {"on", "off"};
  if (key == "listen_unix_mode") return {"600", "660", "666"};
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
  const auto found =
      std::ranges::find_if(settings(), [&](const Setting& s) { return s.key == key; });
  return found == settings().end() ? nullptr : &*found;
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

/// Variables that are not the server's, but of its proxy, of the client, of its build, or of
/// the scripts that run it.
bool is_of_others(std::string_view variable) {
  // Kubernetes tells every pod of its services like this, one of which may be called tetstream.
  const auto has = [&](std::string_view part) { return variable.find(part) != variable.npos; };
  if (has("_SERVICE_HOST") || has("_SERVICE_PORT") || variable.ends_with("_PORT") ||
      (has("_PORT_") && (has("_TCP") || has("_UDP")))) {
    return true;
  }
  constexpr std::string_view kNames[] = {"TETSTREAM_CONFIG", "TETSTREAM_TOKEN_FILE",
                                         "TETSTREAM_MANUAL_DATE", "TETSTREAM_BIN",
                                         "TETSTREAM_BUILD"};
  return variable.starts_with("TETSTREAM_PROXY_") ||
         std::find(std::begin(kNames), std::end(kNames), variable) != std::end(kNames);
}

/// A variable that no setting has would be believed to work.
absl::Status check_variables() {
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::string_view variable = text.substr(0, text.find('='));
    if (!variable.starts_with("TETSTREAM_") || is_of_others(variable)) continue;
    const bool is_known = std::ranges::any_of(
        settings(), [&](const Setting& setting) { return setting.environment() == variable; });
    if (is_known) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("%s is the variable of no setting: unset it, or see --help for their "
                        "names",
                        variable));
  }
  return absl::OkStatus();
}

/// An address without the password in it: of user:password@, or of password=.
std::string without_password(std::string text) {
  const std::size_t scheme = text.find("://");
  if (scheme == std::string::npos) return text;
  const std::size_t begin = scheme + 3;
  const std::size_t end = std::min(text.find_first_of("/?", begin), text.size());
  const std::size_t at = text.rfind('@', end);
  const std::size_t colon = text.find(':', begin);
  if (at != std::string::npos && at > begin && colon < at) {
    text.replace(colon + 1, at - colon - 1, kHidden);
  }
  for (std::string_view key : {"password=", "sslpassword="}) {
    const std::size_t found = text.find(key);
    if (found == std::string::npos) continue;
    const std::size_t value = found + key.size();
    const std::size_t value_end = std::min(text.find('&', value), text.size());
    text.replace(value, value_end - value, kHidden);
  }
  return text;
}

absl::Status prefixed(std::string_view prefix, const absl::Status& status) {
  return {status.code(), absl::StrFormat("%s: %s", prefix, status.message())};
}

}  // namespace

std::string Setting::flag() const { return "--" + absl::StrReplaceAll(key, {{"_", "-"}}); }

std::string Setting::environment() const { return "TETSTREAM_" + absl::AsciiStrToUpper(key); }

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
  if (auto status = check_variables(); !status.ok()) return status;
  for (const Setting& setting : settings()) {
    const std::string variable = setting.environment();
    const char* text = std::getenv(variable.c_str());
    if (text == nullptr) continue;
    const absl::Status status = set_from_text(config, setting, text);
    if (!status.ok()) return prefixed(variable, status);
  }
  return absl::OkStatus();
}

std::string to_toml(const Config& config, Secrets secrets) {
  std::string lines;
  for (const Setting& setting : settings()) {
    toml::table line;
    if (const auto* field = std::get_if<std::string Config::*>(&setting.field)) {
      const std::string& text = config.*(*field);
      line.insert(setting.key, secrets == Secrets::kHidden ? without_password(text) : text);
    } else {
      const auto number = config.*std::get<std::uint64_t Config::*>(setting.field);
      line.insert(setting.key, static_cast<std::int64_t>(number));
    }
    std::ostringstream out;
    out << line;
    absl::StrAppend(&lines, "# ", setting.help, "\n", out.str(), "\n");
  }
  return lines;
}

}  // namespace tet
