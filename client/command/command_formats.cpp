// `tetstream formats`: which mesh files there are, and what each carries.
#include <cstdio>

#include <CLI/CLI.hpp>

#include "client/command/command.h"
#include "core/files/mesh_formats.h"

namespace tet {

Command add_formats_command(CLI::App& app) {
  app.footer(R"(
The ending of the path that -o names chooses the format; --format names it where that does not. What is said of
regions, parts, faces and fields is how a format has them, and a dash that it has none: docs/formats.md.

Examples:
  tetstream formats
  tetstream mesh part.json -o part.inp --spacing 0.05
  tetstream mesh part.json -o part.deck --format inp --spacing 0.05
)");
  return [](const Cancellation&) {
    std::fputs(describe_mesh_formats().c_str(), stdout);
    return absl::OkStatus();
  };
}

}  // namespace tet
