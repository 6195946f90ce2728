#include "server/server_probes.h"

#include <filesystem>
#include <string>
#include <system_error>
#include <unistd.h>

#include <absl/strings/str_cat.h>

#include "core/base/posix/file.h"
#include "core/vdb/parts/find_decoder.h"
#include "proto/convert/status.h"
#include "server/grids/store_identity.h"

namespace tet {

namespace {

constexpr std::chrono::seconds kBetweenProbes{5};

/// A disk that is full takes no uploads, but meshes are made of what is there.
absl::Status probe_store(const std::filesystem::path& store) {
  const auto identity = read_store_identity(store);
  if (!identity.ok()) return identity.status();
  const std::filesystem::path path = store / ".probe";
  auto file = File::open(path, O_WRONLY | O_CREAT | O_TRUNC, io_error, 0600);
  absl::Status written = file.status();
  if (written.ok()) written = file->append(".");
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  return absl::IsResourceExhausted(written) ? absl::OkStatus() : written;
}

absl::Status probe_decoder(const std::string& given) {
  const auto program = find_decoder(given);
  if (!program.ok()) return program.status();
  if (::access(program->c_str(), X_OK) == 0) return absl::OkStatus();
  return with_reason(
      absl::UnavailableError(absl::StrCat("the decoder ", *program, " cannot be run")),
      "DECODER_UNAVAILABLE");
}

}  // namespace

ServerProbes::ServerProbes(const Config& config)
    : store_(
          "store", [path = config.store] { return probe_store(path); }, kBetweenProbes),
      decoder_(
          "decoder",
          [given = config.decoder] { return probe_decoder(given); },
          kBetweenProbes) {}

std::vector<Reading> ServerProbes::readings() const {
  return {gauge("tetstream_store_up", "1 unless the store is gone, fails or does not answer.",
                store_.status().ok()),
          gauge("tetstream_decoder_up", "1 unless the decoder's program cannot be run.",
                decoder_.status().ok())};
}

}  // namespace tet
