// What kairos events does with files of events.
#pragma once

#include "commands.h"

namespace kairos::cli {

void add_events_info_command(CLI::App& events, Action& chosen);
void add_events_compare_command(CLI::App& events, Action& chosen);
void add_events_play_command(CLI::App& events, Action& chosen);

}  // namespace kairos::cli
