// The commands of `tetstream`, each in a file of its own.
#pragma once

#include <functional>

#include <absl/status/status.h>

#include "core/base/cancel.h"

namespace CLI {
class App;
}

namespace tet {

/// Runs after the command line was read. An error's message is for the user, its code decides
/// the exit code.
using Command = std::function<absl::Status(const Cancellation& interruption)>;

/// Each describes a command's options to its `CLI::App` and returns what runs it.
Command add_mesh_command(CLI::App& app);
Command add_report_command(CLI::App& app);
Command add_transfer_command(CLI::App& app);
Command add_sample_command(CLI::App& app);
Command add_estimate_command(CLI::App& app);
Command add_info_command(CLI::App& app);
Command add_convert_command(CLI::App& app);
Command add_formats_command(CLI::App& app);
Command add_health_command(CLI::App& app);
Command add_job_command(CLI::App& app);

}  // namespace tet
