// Work that gives way to what somebody waits for.
#pragma once

#include <string>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

namespace tet {

inline constexpr char kBackground[] = "jobs of ";

/// The client in whose name the batch jobs of a namespace are counted: they take turns with
/// other clients, and their large plans are made with a lower priority.
inline std::string background_client(const std::string& space) {
  return absl::StrCat(kBackground, space);
}
inline bool is_background(const std::string& client) {
  return absl::StartsWith(client, kBackground);
}

/// About a tenth of the weight of other threads.
inline constexpr int kBackgroundNice = 10;

/// Lowers the priority of the calling thread, and of those that it will make.
void give_way();

}  // namespace tet
