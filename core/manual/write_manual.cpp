#include "core/manual/write_manual.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

#include "core/manual/command_help.h"
#include "core/manual/completion.h"
#include "core/manual/man_page.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

void write_page(const fs::path& path, const std::string& text) {
  std::error_code failed;  // then the file cannot be opened
  fs::create_directories(path.parent_path(), failed);
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw CLI::FileError(path.string() + " cannot be written");
}

void write_pages(const fs::path& folder,
                 const CommandHelp& command,
                 const ManualEdition& edition) {
  const std::string file = absl::StrCat(joined_path(command, "-"), ".", edition.section);
  write_page(folder / file, man_page(command, edition));
  for (const CommandHelp& each : command.commands) write_pages(folder, each, edition);
}

void write_manual(const fs::path& folder,
                  const CommandHelp& program,
                  const ManualEdition& edition) {
  const std::string& name = program.path.front();
  write_pages(folder / "man", program, edition);
  write_page(folder / "bash" / name, bash_completion(program));
  write_page(folder / "zsh" / ("_" + name), zsh_completion(program));
  write_page(folder / "fish" / (name + ".fish"), fish_completion(program));
}

}  // namespace

void add_manual_option(CLI::App& app, const std::string& section, const std::string& version) {
  app.add_option_function<std::string>(
         "--write-manual",
         [&app, section, version](const std::string& folder) {
           const char* date = std::getenv("TETSTREAM_MANUAL_DATE");
           write_manual(folder, read_help(app),
                        {section, version, date != nullptr ? date : ""});
           throw CLI::Success();
         })
      ->trigger_on_parse()
      ->group("");
}

}  // namespace tet
