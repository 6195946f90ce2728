// What every fuzz target is made of: a file NAME_fuzz.cpp, in a namespace of its own, with
//   TET_FUZZ_TARGET(NAME_fuzz) { ... data ... size ... return 0; }
// With libFuzzer each is a program. Elsewhere one program, fuzz_replay, has them all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>

namespace tet {

/// Takes `size` bytes at `data`, and ends the process where a promise is broken. Returns 0.
using FuzzTarget = int (*)(const std::uint8_t* data, std::size_t size);

/// The targets of this program by name; empty where libFuzzer calls its only one.
std::map<std::string, FuzzTarget>& fuzz_targets();

/// What holds once a target has run over all its first inputs, which fuzz_replay then asks.
std::map<std::string, void (*)()>& replay_checks();

/// Ends the process in a way that libFuzzer and ctest see.
inline void require(bool promise) {
  if (!promise) std::abort();
}

}  // namespace tet

#ifdef TET_LIBFUZZER
#define TET_FUZZ_TARGET(name) \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#else
#define TET_FUZZ_TARGET(name)                                                             \
  static int name(const std::uint8_t* data, std::size_t size);                            \
  static const bool name##_is_listed = ::tet::fuzz_targets().emplace(#name, name).second; \
  static int name(const std::uint8_t* data, std::size_t size)
#endif
