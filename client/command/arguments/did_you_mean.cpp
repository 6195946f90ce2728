#include "client/command/arguments/did_you_mean.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

namespace tet {
namespace {

/// Letters left out, put in, replaced, or exchanged with their neighbours.
std::size_t count_slips(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> slips(a.size() + 1,
                                              std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        slips[i][j] = i + j;
        continue;
      }
      const bool same = a[i - 1] == b[j - 1];
      slips[i][j] = std::min(
          {slips[i - 1][j] + 1, slips[i][j - 1] + 1, slips[i - 1][j - 1] + (same ? 0U : 1U)});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) slips[i][j] = std::min(slips[i][j], slips[i - 2][j - 2] + 1);
    }
  }
  return slips[a.size()][b.size()];
}

/// Empty where nothing is spelt nearly so.
std::string nearest_command(const CLI::App& app, std::string_view word) {
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(1, word.size() / 3);
  for (const CLI::App* command : app.get_subcommands({})) {
    const std::size_t slips = count_slips(word, command->get_name());
    if (slips > fewest || (slips == fewest && !nearest.empty())) continue;
    fewest = slips;
    nearest = command->get_name();
  }
  return nearest;
}

/// The command whose own command is missing.
const CLI::App* incomplete(const CLI::App& app) {
  const std::vector<CLI::App*> given = app.get_subcommands();
  const CLI::App* const last = given.empty() ? &app : incomplete(*given.back());
  return last == nullptr || last->get_subcommands({}).empty() ? nullptr : last;
}

}  // namespace

std::string unknown_command(const CLI::App& app) {
  const CLI::App* const command = incomplete(app);
  if (command == nullptr) return "";
  const std::vector<std::string> rest = app.remaining(/*recurse=*/true);
  if (rest.empty() || rest.front().starts_with('-')) return "";
  const std::string nearest = nearest_command(*command, rest.front());
  return absl::StrCat("unknown command ", absl::Utf8SafeCHexEscape(rest.front()),
                      nearest.empty() ? "" : absl::StrCat("; did you mean ", nearest, "?"));
}

}  // namespace tet
