#include "server/ops/config.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/test_folder.h"

namespace tet {
namespace {

using testing::HasSubstr;

const Setting& setting(std::string_view key) {
  for (const Setting& candidate : settings()) {
    if (candidate.key == key) return candidate;
  }
  std::abort();
}

TEST(Config, ReadsBackWhatItPrints) {
  const test::TestFolder folder;
  Config written;
  written.listen = "[::1]:9";
  written.store = "a \"quoted\" folder";
  written.store_bytes = 12345;
  Config read;
  ASSERT_TRUE(set_from_file(read, folder.write("c.toml", to_toml(written))).ok());
  EXPECT_EQ(to_toml(read), to_toml(written));
}

TEST(Config, UnderstandsUnits) {
  Config config;
  ASSERT_TRUE(set_from_text(config, setting("store_bytes"), "3GiB").ok());
  EXPECT_EQ(config.store_bytes, 3ULL << 30);
}

TEST(Config, RefusesNumbersWithTheirRange) {
  Config config;
  for (const char* text :
       {"-1", "0", "x", "1kB", "", "99999999999999999999", "9999999999TiB"}) {
    const auto status = set_from_text(config, setting("store_bytes"), text);
    EXPECT_THAT(std::string(status.message()), HasSubstr("store_bytes \"" + std::string(text)));
  }
}

TEST(Config, NamesAnUnknownKeyAndItsLine) {
  const test::TestFolder folder;
  Config config;
  const auto status =
      set_from_file(config, folder.write("c.toml", "threads = 2\ntreads = 3\n"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("c.toml:2: unknown key \"treads\""));
}

TEST(Config, NamesALineThatIsNotToml) {
  const test::TestFolder folder;
  Config config;
  const auto status = set_from_file(config, folder.write("c.toml", "threads = \n"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("c.toml:1: "));
}

TEST(Config, RefusesAFileThatIsNotThere) {
  Config config;
  EXPECT_FALSE(set_from_file(config, "/nowhere/c.toml").ok());
}

TEST(Config, RefusesAVariableThatNoSettingHas) {
  ::setenv("TETSTREAM_STOER_BYTES", "1GiB", 1);
  Config config;
  const auto status = set_from_environment(config);
  ::unsetenv("TETSTREAM_STOER_BYTES");
  EXPECT_THAT(std::string(status.message()), HasSubstr("TETSTREAM_STOER_BYTES"));
}

TEST(Config, LeavesVariablesOfOthersAlone) {
  const char* const others[] = {"TETSTREAM_PROXY_LISTEN", "TETSTREAM_SERVICE_HOST",
                                "TETSTREAM_WEB_SERVICE_PORT_GRPC", "TETSTREAM_PORT",
                                "TETSTREAM_PORT_7447_TCP_ADDR"};
  for (const char* variable : others) ::setenv(variable, "x", 1);
  Config config;
  EXPECT_EQ(set_from_environment(config), absl::OkStatus());
  for (const char* variable : others) ::unsetenv(variable);
}

TEST(Config, HidesPasswords) {
  Config config;
  for (const char* jobs :
       {"postgresql://ana:s3cret@db/tetstream", "postgresql://db/x?user=ana&password=s3cret",
        "postgresql://ana:s3cret@db:5432/x?sslpassword=s3cret&host=h"}) {
    config.jobs = jobs;
    const std::string printed = to_toml(config, Secrets::kHidden);
    EXPECT_THAT(printed, testing::Not(HasSubstr("s3cret")));
    EXPECT_THAT(printed, HasSubstr("***"));
    EXPECT_THAT(to_toml(config), HasSubstr("s3cret"));
  }
  config.jobs = "/var/lib/jobs:old@2025.sqlite";
  EXPECT_THAT(to_toml(config, Secrets::kHidden), HasSubstr(config.jobs));
}

TEST(Config, NamesAWrongVariable) {
  ::setenv("TETSTREAM_LOG_LEVEL", "loud", 1);
  Config config;
  const auto status = set_from_environment(config);
  ::unsetenv("TETSTREAM_LOG_LEVEL");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("TETSTREAM_LOG_LEVEL: log_level \"loud\""));
}

}  // namespace
}  // namespace tet
