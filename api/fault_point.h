// Named places where a test cuts a process off as a loss of power would, or halts it to change the world.
#pragma once

#include <string_view>

namespace api {

/// Ends this process by SIGKILL where the environment says KEYLUME_FAULT=NAME, or NAME:3 when it comes by for
/// the third time (1 and up); with NAME:3:stop it is halted there by SIGSTOP, until somebody sends SIGCONT.
/// Costs a comparison where it says nothing. Safe for use by several threads. tests/faults knows every name
/// that is passed here, and goes through all of them.
void fault_point(std::string_view name);

}  // namespace api
