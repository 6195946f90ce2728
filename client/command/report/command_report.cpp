// `tetstream report`: a mesh's report in, a page of drawings out.
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "client/command/arguments/output_places.h"
#include "client/command/command.h"
#include "client/command/report/report_page.h"
#include "client/library/text_file.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/printable.h"

namespace tet {
namespace {

constexpr const char* kReportExamples = R"(
Examples:
  tetstream mesh bunny.vdb -o bunny.vtu --report bunny.json
  tetstream report bunny.json -o bunny.html
      histograms of angles, shapes and sizes, how far the surface is from the true one, and
      where the worst tets are, in a page that needs nothing else; docs/report.md
)";

struct ReportOptions {
  std::string report, output, title;
};

absl::Status run_report(const ReportOptions& options, const Cancellation& interruption) {
  if (auto status = check_can_create(options.output); !status.ok()) return status;
  if (auto status = check_takes_no_place(options.output, {options.report}); !status.ok()) {
    return status;
  }
  const absl::StatusOr<std::string> text = read_text_file(options.report, interruption);
  if (!text.ok()) return text.status();
  const std::string& title = options.title.empty() ? options.report : options.title;
  const absl::StatusOr<std::string> page = report_page(*text, title);
  if (!page.ok()) return about(options.report, page.status());
  if (auto status = write_text_file(options.output, *page); !status.ok()) return status;
  std::printf("%s: a page of %s\n", for_terminal(options.output).c_str(),
              for_terminal(options.report).c_str());
  return absl::OkStatus();
}

}  // namespace

Command add_report_command(CLI::App& app) {
  const auto options = std::make_shared<ReportOptions>();
  app.footer(kReportExamples);
  app.add_option("REPORT", options->report, "What `tetstream mesh --report` wrote")->required();
  app.add_option("-o,--output", options->output, "The page, HTML")->required();
  app.add_option("--title", options->title, "Its heading [the report's path]")
      ->type_name("TEXT");
  return [options](const Cancellation& interruption) {
    return run_report(*options, interruption);
  };
}

}  // namespace tet
