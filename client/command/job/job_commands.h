// The commands of `tetstream job`, each in a file of its own.
#pragma once

#include "client/command/command.h"

namespace tet {

Command add_submit_command(CLI::App& app);
Command add_list_command(CLI::App& app);
Command add_show_command(CLI::App& app);
Command add_watch_command(CLI::App& app);
Command add_wait_command(CLI::App& app);
Command add_cancel_command(CLI::App& app);
Command add_retry_command(CLI::App& app);
Command add_fetch_command(CLI::App& app);
Command add_delete_command(CLI::App& app);
Command add_workers_command(CLI::App& app);

}  // namespace tet
