#include "server/rpc/token_file.h"

#include <filesystem>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/wire/sha256.h"
#include "tests/server/test_folder.h"

namespace tet {
namespace {

using testing::HasSubstr;
using testing::Not;

class TokenFileTest : public testing::Test {
 protected:
  absl::StatusOr<std::vector<Token>> read(const std::string& text, unsigned mode = 0600) {
    const std::string path = folder_.write("tokens.toml", text);
    std::filesystem::permissions(path, std::filesystem::perms(mode));
    return read_token_file(path);
  }

  std::string refusal(const std::string& text, unsigned mode = 0600) {
    const auto tokens = read(text, mode);
    EXPECT_TRUE(absl::IsInvalidArgument(tokens.status())) << tokens.status();
    return std::string(tokens.status().message());
  }

  /// An entry with one key replaced; an empty value leaves the key out.
  static std::string entry(const std::string& key = "", const std::string& value = "") {
    std::map<std::string, std::string> usual;
    usual["name"] = "\"a\"";
    usual["sha256"] = '"' + std::string(64, 'a') + '"';
    usual["scopes"] = "[\"mesh\"]";
    usual["namespace"] = "\"ours\"";
    if (!key.empty()) usual[key] = value;
    std::string text = "[[token]]\n";
    for (const auto& [name, used] : usual) {
      if (!used.empty()) text += name + " = " + used + "\n";
    }
    return text;
  }

  test::TestFolder folder_;
};

TEST_F(TokenFileTest, ReadsWhatItSays) {
  const auto tokens = read(entry("scopes", "[\"grids.read\", \"mesh\"]"));
  ASSERT_TRUE(tokens.ok()) << tokens.status();
  ASSERT_EQ(tokens->size(), 1U);
  EXPECT_EQ(tokens->front().space, "ours");
  EXPECT_TRUE(tokens->front().allows(Scope::kMesh));
  EXPECT_FALSE(tokens->front().allows(Scope::kGridsWrite));
  EXPECT_FALSE(tokens->front().expires);
}

TEST_F(TokenFileTest, UnderstandsTimeZones) {
  const auto tokens = read(entry("expires", "2030-01-01T02:00:00+02:00"));
  ASSERT_TRUE(tokens.ok()) << tokens.status();
  EXPECT_EQ(absl::FormatTime(*tokens->front().expires, absl::UTCTimeZone()),
            "2030-01-01T00:00:00+00:00");
}

TEST_F(TokenFileTest, NamesTheLineOfAWrongEntry) {
  const std::string good = entry();
  EXPECT_THAT(refusal(good + entry()), HasSubstr("tokens.toml:6: name is taken"));
  EXPECT_THAT(refusal(entry("sha256", "")), HasSubstr(":1: sha256 is missing"));
  EXPECT_THAT(refusal(entry("scopes", "")), HasSubstr("scopes is missing"));
  EXPECT_THAT(refusal(entry("scopes", "[\"all\"]")), HasSubstr("none of grids.read"));
  EXPECT_THAT(refusal(entry("namespace", "\"../x\"")), HasSubstr("namespace is not"));
  EXPECT_THAT(refusal(entry("namespace", "")), HasSubstr("namespace is not"));
  EXPECT_THAT(refusal(entry("expires", "2030-01-01T02:00:00")), HasSubstr("its zone"));
  EXPECT_THAT(refusal("tokens = 3\n"), HasSubstr("more than [[token]]"));
  EXPECT_THAT(refusal("\n[[token"), HasSubstr("tokens.toml:2: not TOML"));
}

TEST_F(TokenFileTest, RepeatsNothingThatCouldBeASecret) {
  EXPECT_THAT(refusal(entry("sha256", "\"hunter2\"")), Not(HasSubstr("hunter2")));
  EXPECT_THAT(refusal(entry() + "hunter2 = 1\n"), Not(HasSubstr("hunter2")));
  EXPECT_THAT(refusal("hunter2"), Not(HasSubstr("hunter2")));
}

TEST_F(TokenFileTest, MustBeItsOwnersAlone) {
  EXPECT_TRUE(read(entry(), 0440).ok()) << "its group may read it";
  EXPECT_THAT(refusal(entry(), 0660), HasSubstr("mode 660"));
  EXPECT_THAT(refusal(entry(), 0644), HasSubstr("chmod 640"));
}

TEST_F(TokenFileTest, TakesTheEntryOfANewToken) {
  const auto token = make_token("alice");
  ASSERT_TRUE(token.ok()) << token.status();
  const auto tokens = read(token->entry);
  ASSERT_TRUE(tokens.ok()) << tokens.status();
  Sha256 digest;
  digest.add(token->text);
  EXPECT_EQ(tokens->front().sha256, digest.finish_hex());
  EXPECT_EQ(tokens->front().name, "alice");
  EXPECT_NE(make_token("alice")->text, token->text);
  EXPECT_FALSE(make_token("Alice Smith").ok());
}

}  // namespace
}  // namespace tet
