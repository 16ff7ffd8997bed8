// What a bench ran on.
#pragma once

#include <string>

namespace engine {

struct Machine {
  std::string cpu;       ///< as the kernel names its model
  unsigned cores = 0;    ///< that this process may use
  double memory_gb = 0;  ///< 10^9 bytes
  std::string isa;       ///< the widest registers that our kernels use here
  std::string compiler;  ///< of this program
  std::string embree;    ///< version that this program was built with
  double load = 0;       ///< load_per_core, before anything was run
};

/// Load per core beyond which times are not those of an idle machine.
inline constexpr double kIdleLoad = 0.3;

/// Other programs at work on this machine: load average over its cores, of the last minute; 0 where unknown.
/// Ask before the first run: our own runs load it too.
double load_per_core();

Machine this_machine();

/// One line, and a warning where other programs are at work.
std::string words_of(const Machine& machine);

}  // namespace engine
