#include "core/manual/man_page.h"

#include <algorithm>
#include <span>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>

namespace tet {
namespace {

/// Text as troff prints it: characters that it would take for typographic ones stay what they
/// are, so that examples can be copied from the page.
std::string escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"\\", "\\e"},
                                    {"-", "\\-"},
                                    {"'", "\\(aq"},
                                    {"`", "\\(ga"},
                                    {"^", "\\(ha"},
                                    {"~", "\\(ti"}});
}

/// A line that troff must not take for a request.
std::string escaped_line(const std::string& text) {
  return absl::StrCat(absl::StartsWith(text, ".") ? "\\&" : "", escaped(text));
}

std::string bold(const std::string& text) {
  return absl::StrCat("\\fB", escaped(text), "\\fR");
}
std::string italic(const std::string& text) {
  return absl::StrCat("\\fI", escaped(text), "\\fR");
}

bool is_indented(const std::string& line) { return absl::StartsWith(line, " "); }

/// "Examples:" above indented lines is a heading.
bool is_heading(std::span<const std::string> lines, std::size_t i) {
  return absl::EndsWith(lines[i], ":") && !is_indented(lines[i]) && i + 1 < lines.size() &&
         is_indented(lines[i + 1]) && (i == 0 || lines[i - 1].empty());
}

std::string heading(const std::string& line) {
  return absl::StrCat(".SH ", escaped(absl::AsciiStrToUpper(line.substr(0, line.size() - 1))),
                      "\n");
}

/// Paragraphs are filled, indented lines stay as they are, headings begin sections.
std::string as_paragraphs(std::span<const std::string> lines) {
  std::string page;
  bool as_it_is = false, begins = true;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    if (as_it_is && !is_indented(line)) page += ".EE\n";
    if (!as_it_is && is_indented(line)) page += begins ? ".EX\n" : ".PP\n.EX\n";
    as_it_is = is_indented(line);
    if (line.empty()) {
      if (!begins && i + 1 < lines.size() && !is_heading(lines, i + 1)) page += ".PP\n";
      begins = true;
      continue;
    }
    begins = is_heading(lines, i);
    absl::StrAppend(&page, begins ? heading(line) : escaped_line(line) + "\n");
  }
  return page + (as_it_is ? ".EE\n" : "");
}

std::vector<std::string> lines_of(const std::string& text) {
  return absl::StrSplit(absl::StripAsciiWhitespace(text), '\n');
}

/// A space in front is kept: it makes the first line an example.
std::vector<std::string> footer_lines(const std::string& footer) {
  const std::size_t begin = footer.find_first_not_of('\n');
  if (begin == std::string::npos) return {};
  return absl::StrSplit(absl::StripTrailingAsciiWhitespace(footer.substr(begin)), '\n');
}

std::size_t first_heading(std::span<const std::string> lines) {
  std::size_t i = 0;
  while (i < lines.size() && !is_heading(lines, i)) ++i;
  return i;
}

std::string value_of(const OptionHelp& option) {
  return absl::StrCat(option.value.empty() ? "" : " " + italic(option.value),
                      option.repeats ? " ..." : "");
}

std::string remarks_on(const OptionHelp& option) {
  std::string text;
  if (option.required) text += " Required.";
  if (!option.choices.empty()) {
    absl::StrAppend(&text, " One of ", absl::StrJoin(option.choices, ", "), ".");
  }
  if (!option.limit.empty()) absl::StrAppend(&text, " Allowed: ", option.limit, ".");
  if (!option.environment.empty()) {
    absl::StrAppend(&text, " Environment: ", option.environment, ".");
  }
  if (!option.excludes.empty()) {
    absl::StrAppend(&text, " Not with ", absl::StrJoin(option.excludes, ", "), ".");
  }
  return text;
}

std::string option_entry(const OptionHelp& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(bold(name));
  const std::string remarks = remarks_on(option);
  const std::string end = remarks.empty() || absl::EndsWith(option.about, ".") ? "" : ".";
  return absl::StrCat(".TP\n", absl::StrJoin(names, ", "), value_of(option), "\n",
                      escaped_line(option.about), end, escaped(remarks), "\n");
}

std::string positional_entry(const OptionHelp& option) {
  return absl::StrCat(".TP\n", italic(option.names.front()), option.repeats ? " ..." : "", "\n",
                      escaped_line(option.about), "\n");
}

std::string first_line(const std::string& about) { return about.substr(0, about.find('\n')); }

std::string name_section(const CommandHelp& command) {
  // By convention the line is no sentence.
  std::string about = first_line(command.about);
  if (absl::EndsWith(about, ".")) about.pop_back();
  about.front() = absl::ascii_tolower(static_cast<unsigned char>(about.front()));
  return absl::StrCat(".SH NAME\n", escaped(joined_path(command, "-")), " \\- ", escaped(about),
                      "\n");
}

std::string synopsis_section(const CommandHelp& command) {
  std::string page = absl::StrCat(".SH SYNOPSIS\n", bold(joined_path(command, " ")));
  if (!command.options.empty()) absl::StrAppend(&page, " [", italic("OPTIONS"), "]");
  for (const OptionHelp& positional : command.positionals) {
    const std::string name =
        italic(positional.names.front()) + (positional.repeats ? "..." : "");
    absl::StrAppend(&page, " ", positional.required ? name : "[" + name + "]");
  }
  if (!command.commands.empty()) {
    const std::string name = italic("COMMAND");
    absl::StrAppend(&page, " ", command.needs_command ? name : "[" + name + "]");
  }
  return page + "\n";
}

std::string description_section(const CommandHelp& command,
                                std::span<const std::string> footer) {
  const std::vector<std::string> about = lines_of(command.about);
  std::string page = absl::StrCat(".SH DESCRIPTION\n", as_paragraphs(about));
  const auto more = footer.first(first_heading(footer));
  return more.empty() ? page : absl::StrCat(page, ".PP\n", as_paragraphs(more));
}

std::string commands_section(const CommandHelp& command) {
  std::string page = ".SH COMMANDS\n";
  for (const CommandHelp& each : command.commands) {
    absl::StrAppend(&page, ".TP\n", bold(each.path.back()), "\n", escaped_line(each.about),
                    "\n");
  }
  return page;
}

/// One section for each group of --help, in the order in which it shows them.
std::string option_sections(const CommandHelp& command) {
  std::vector<std::string> groups;
  for (const OptionHelp& option : command.options) {
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string page;
  for (const std::string& group : groups) {
    const std::string title = absl::AsciiStrToUpper(group);
    const std::string suffix = absl::EndsWith(title, "OPTIONS") ? "" : " OPTIONS";
    absl::StrAppend(&page, ".SH ", escaped(title), suffix, "\n");
    for (const OptionHelp& option : command.options) {
      if (option.group == group) page += option_entry(option);
    }
  }
  return page;
}

/// The page above this one, and those below.
std::string see_also_section(const CommandHelp& command, const std::string& section) {
  std::vector<std::string> pages;
  const auto add = [&](const std::string& name) {
    pages.push_back(absl::StrCat(bold(name), "(", section, ")"));
  };
  if (command.path.size() > 1) {
    add(absl::StrJoin(command.path.begin(), command.path.end() - 1, "-"));
  }
  for (const CommandHelp& each : command.commands) add(joined_path(each, "-"));
  return pages.empty() ? "" : absl::StrCat(".SH SEE ALSO\n", absl::StrJoin(pages, ",\n"), "\n");
}

}  // namespace

std::string man_page(const CommandHelp& command, const ManualEdition& edition) {
  const std::string title = absl::AsciiStrToUpper(joined_path(command, "-"));
  const std::vector<std::string> footer = footer_lines(command.footer);
  std::string page = absl::StrCat(".\\\" Made from the command's own --help: change that.\n",
                                  ".TH ", escaped(title), " ", edition.section, " ",
                                  edition.date, " \"", edition.version, "\"\n");
  page +=
      name_section(command) + synopsis_section(command) + description_section(command, footer);
  if (!command.positionals.empty()) page += ".SH ARGUMENTS\n";
  for (const OptionHelp& positional : command.positionals) page += positional_entry(positional);
  if (!command.commands.empty()) page += commands_section(command);
  page += option_sections(command);
  page += as_paragraphs(std::span(footer).subspan(first_heading(footer)));
  return page + see_also_section(command, edition.section);
}

}  // namespace tet
