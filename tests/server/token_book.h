// A file of tokens that a test writes.
#pragma once

#include <filesystem>
#include <string>

#include "proto/wire/sha256.h"
#include "tests/server/test_folder.h"

namespace tet::test {

class TokenBook {
 public:
  explicit TokenBook(const TestFolder& folder) : folder_(folder) { write(""); }

  std::string file() const { return folder_.file("tokens.toml"); }

  /// Adds an entry to the file; returns the token.
  std::string add(const std::string& name,
                  const std::string& scopes,
                  const std::string& space,
                  const std::string& expires = "2999-01-01T00:00:00Z") {
    const std::string token = "secret-of-" + name;
    Sha256 digest;
    digest.add(token);
    write(text_ + "[[token]]\nname = \"" + name + "\"\nsha256 = \"" + digest.finish_hex() +
          "\"\nscopes = [" + scopes + "]\nnamespace = \"" + space + "\"\nexpires = " + expires +
          "\n");
    return token;
  }

  /// Replaces the file as an operator should: whole, by a rename.
  void write(const std::string& text) {
    text_ = text;
    const std::string unfinished = folder_.write("tokens.new", text);
    std::filesystem::permissions(unfinished, std::filesystem::perms(0600));
    std::filesystem::rename(unfinished, file());
  }

 private:
  const TestFolder& folder_;
  std::string text_;
};

}  // namespace tet::test
