// How tests know that a decoder hangs over its order: hostile_decoder.cpp leaves its number in
// a file.
#pragma once

#include <fstream>
#include <string>
#include <sys/types.h>

#include "tests/support/eventually.h"

namespace tet::test {

/// What is appended to the program's name.
constexpr char kHangs[] = ".hangs";

/// Whether a process of this program hangs, and which.
inline bool hangs(const std::string& program, pid_t& pid) {
  return static_cast<bool>(std::ifstream(program + kHangs) >> pid);
}
inline bool hangs(const std::string& program) {
  pid_t pid = 0;
  return hangs(program, pid);
}

/// The process of this program that comes to hang over an order; 0 if none does.
inline pid_t hanging_decoder(const std::string& program) {
  pid_t pid = 0;
  eventually([&] { return hangs(program, pid); });
  return pid;
}

/// Whether nothing of a process runs any more: it is gone, or waits to be reaped.
inline bool has_ended(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(status, text)) return true;
  return text.at(text.rfind(')') + 2) == 'Z';
}

}  // namespace tet::test
