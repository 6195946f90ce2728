// Files to decode, and decoders that do not.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/failure_name.h"
#include "core/vdb/decoder/decode_file.h"
#include "tests/support/eventually.h"
#include "tests/support/test_directory.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::test {

/// A decoder that has all the time there is: what is no matter of the clock must not be ended
/// by it, where a machine is slow. An empty path finds it.
inline DecoderProgram patient_program(const std::string& path = "",
                                      std::vector<std::string> environment = {}) {
  return {path, std::move(environment), {.start = kGenerousEnd, .last_moment = kGenerousEnd}};
}

/// Gives each decoder of a pool all the time there is, too; `processes` of them run at once.
inline DecoderSettings patient_settings(const std::string& path = "", int processes = 0) {
  return {.program = patient_program(path),
          .processes = processes,
          .max_time = kGenerousEnd,
          .least_time = kGenerousEnd};
}

class DecodeTest : public ::testing::Test {
 protected:
  DecodeTest() { write_fixture("sphere", 0.1, path_); }

  /// The program of hostile_decoder.cpp that does what `deed` says.
  std::string hostile(const std::string& deed) {
    const std::string link = directory_.file("decoder." + deed);
    std::filesystem::create_symlink(HOSTILE_DECODER_PATH, link);
    return link;
  }

  FileRequest request(const std::string& grid_name = "") const {
    return {DecodeTask::kVolume, path_, "grids/abc", grid_name, std::uint64_t{64} << 20};
  }

  /// What the request gets from a decoder that does `deed`.
  absl::Status outcome(const std::string& deed) {
    return outcome(patient_settings(hostile(deed)));
  }
  absl::Status outcome(const DecoderSettings& settings) const {
    return volume_of(decode_once(request(), settings, nullptr), request()).status();
  }

  TestDirectory directory_;
  std::string path_ = directory_.file("sphere.vdb");
};

}  // namespace tet::test
