#include "server/workers/budget.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

namespace server {
namespace {

constexpr std::int64_t kMegabyte = 1 << 20;

std::int64_t memory_here() {
  std::int64_t bytes = static_cast<std::int64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGESIZE);
  // Of a container. The file says "max" where there is no limit, which is no number.
  std::int64_t limit = 0;
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit && limit > 0) bytes = std::min(bytes, limit);
  return bytes;
}

}  // namespace

WorkerBudget make_budget(unsigned cores, std::int64_t memory_mb) {
  if (cores == 0) cores = std::max(1u, std::thread::hardware_concurrency());
  return {static_cast<std::int64_t>(cores), memory_mb > 0 ? memory_mb * kMegabyte : memory_here() / 5 * 4};
}

}  // namespace server
