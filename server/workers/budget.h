// What the workers may take of this machine.
#pragma once

#include <cstdint>

#include "server/jobs/job_rules.h"

namespace server {

/// `cores` and `memory_mb` as the operator says, or where 0 all cores and four fifths of the memory that this
/// machine, or the container we are in, has.
WorkerBudget make_budget(unsigned cores, std::int64_t memory_mb);

}  // namespace server
