#include "api/fault_point.h"

#include <signal.h>

#include <atomic>
#include <charconv>
#include <cstdlib>
#include <string>

namespace api {
namespace {

struct AskedFault {
  std::string name;
  unsigned times = 1;
  int signal = SIGKILL;
};

/// Read once: what changes the environment later changes nothing.
const AskedFault& fault_asked_for() {
  static const AskedFault asked = [] {
    const char* value = std::getenv("KEYLUME_FAULT");
    const std::string_view text = value ? value : "";
    const std::size_t colon = text.find(':');
    AskedFault fault{std::string(text.substr(0, colon))};
    if (text.ends_with(":stop")) fault.signal = SIGSTOP;
    if (colon != text.npos)
      (void)std::from_chars(text.data() + colon + 1, text.data() + text.size(), fault.times);
    return fault;
  }();
  return asked;
}

}  // namespace

void fault_point(std::string_view name) {
  const AskedFault& fault = fault_asked_for();
  if (fault.name.empty() || fault.name != name) return;
  static std::atomic<unsigned> passed = 0;
  // To this thread: sent to the process, SIGSTOP may be taken by another while this one goes on.
  if (++passed == fault.times) (void)::raise(fault.signal);
}

}  // namespace api
