#include "server/workers/budget.h"

#include <unistd.h>

#include <algorithm>
#include <thread>

#include "server/workers/control_group.h"

namespace server {
namespace {

constexpr std::int64_t kMegabyte = 1 << 20;

std::int64_t memory_here() {
  const std::int64_t bytes = static_cast<std::int64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGESIZE);
  return std::min(bytes, group_memory_limit_bytes().value_or(bytes));
}

unsigned cores_here() {
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  return std::min(cores, group_core_limit().value_or(cores));
}

}  // namespace

WorkerBudget make_budget(unsigned cores, std::int64_t memory_mb) {
  if (cores == 0) cores = cores_here();
  return {static_cast<std::int64_t>(cores), memory_mb > 0 ? memory_mb * kMegabyte : memory_here() / 5 * 4};
}

}  // namespace server
