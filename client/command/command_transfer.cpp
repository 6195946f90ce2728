// `tetstream transfer`: the arrays of one mesh file on the mesh of another.
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include "client/command/command.h"
#include "core/base/parallel.h"
#include "core/base/printable.h"
#include "core/files/transfer_files.h"

namespace tet {
namespace {

constexpr const char* kTransferExamples = R"(
Examples:
  tetstream transfer old.vtu new.vtu -o filled.vtu
      what was solved on the old mesh, on the new one: points get what the tet around them says,
      cells the value of the cell around their middle
  tetstream transfer old.vtu new.vtu -o filled.vtu --mode conservative --clamp
      integrals stay, and no value is larger or smaller than the old ones are; docs/transfer.md
  tetstream transfer old.vtu new.vtu -o filled.vtu --array temperature --array heat
      some arrays of many
)";

struct TransferCommand {
  TransferFiles files;
  std::string mode = "linear";
  TransferOptions options;
  int threads = 0;
};

std::string integral_line(const TransferredArray& array) {
  return absl::StrFormat("  %s (%s): integral %.9g, was %.9g", array.name,
                         array.at_points ? "points" : "cells", array.new_integral,
                         array.old_integral);
}

void tell(const std::string& output, const TransferReport& report) {
  std::printf("%s: %zu points, %zu tets, %zu %s\n", for_terminal(output).c_str(), report.points,
              report.tets, report.arrays.size(),
              report.arrays.size() == 1 ? "array" : "arrays");
  for (const TransferredArray& array : report.arrays) {
    std::printf("%s\n", for_terminal(integral_line(array)).c_str());
  }
  if (!report.left_out.empty()) {
    const std::string names = absl::StrJoin(report.left_out, ", ");
    std::fprintf(stderr,
                 "note: arrays of the new mesh as a whole are not kept unless they are "
                 "text: %s\n",
                 for_terminal(names).c_str());
  }
  if (report.outside_points == 0 && report.outside_cells == 0) return;
  std::fprintf(
      stderr, "%s\n",
      absl::StrFormat("note: %d points and the middles of %d cells lie outside the old "
                      "mesh, at most %.4g away",
                      report.outside_points, report.outside_cells, report.farthest)
          .c_str());
}

absl::Status run_transfer(const TransferCommand& command, const Cancellation& interruption) {
  TransferOptions options = command.options;
  options.mode = command.mode == "linear" ? TransferMode::kLinear : TransferMode::kConservative;
  TaskPool pool(command.threads);
  const auto report = transfer_files(pool, command.files, options, interruption);
  if (!report.ok()) return report.status();
  tell(command.files.output, *report);
  return absl::OkStatus();
}

}  // namespace

Command add_transfer_command(CLI::App& app) {
  const auto command = std::make_shared<TransferCommand>();
  app.footer(kTransferExamples);
  app.add_option("OLD", command->files.from, "A .vtu with arrays")->required();
  app.add_option("NEW", command->files.to, "A .vtu whose mesh is to have them")->required();
  app.add_option("-o,--output", command->files.output, "The .vtu to write: NEW with the arrays")
      ->required();
  app.add_option("--mode", command->mode,
                 "linear (what is linear stays so) or conservative (integrals stay) [linear]")
      ->check(CLI::IsMember({"linear", "conservative"}));
  app.add_flag("--clamp", command->options.clamp,
               "No value beyond the old ones: of the tet it comes from, or if conservative of "
               "the whole array");
  app.add_option("--array", command->options.arrays,
                 "Array to transfer; may be repeated [all of OLD]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option("--threads", command->threads, "Threads of this process [every core]")
      ->check(CLI::NonNegativeNumber);
  return [command](const Cancellation& interruption) {
    return run_transfer(*command, interruption);
  };
}

}  // namespace tet
