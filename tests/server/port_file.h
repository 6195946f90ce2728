// The port that a server writes into a file once it serves.
#pragma once

#include <filesystem>
#include <string>

#include "tests/server/test_folder.h"
#include "tests/support/eventually.h"

namespace tet::test {

/// Empty if it does not come to be written.
inline std::string port_in(const std::string& path) {
  if (!eventually([&] { return std::filesystem::exists(path); })) return "";
  std::string port = read_text(path);
  port.pop_back();  // the end of the line
  return port;
}

}  // namespace tet::test
