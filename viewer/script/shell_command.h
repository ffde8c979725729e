// A command of a script, by /bin/sh, without waiting for it.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "shared/result.h"

namespace meshfront {

// In a process group of its own. What it prints goes to stderr; it reads nothing.
[[nodiscard]] Result<pid_t> startShellCommand(const std::string& command);
// Its exit status once it has ended (128 + signal, as shells have it); asked for once then.
[[nodiscard]] std::optional<int> shellCommandStatus(pid_t command);
// Kills its group and takes it away.
void endShellCommand(pid_t command);

}  // namespace meshfront
