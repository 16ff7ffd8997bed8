// Whose turn it is: the order in which jobs are taken from the queue.
//
// The jobs of one owner go by their rank, see 0004_queue.sql: by priority, and a minute of waiting is worth a
// point. Between owners goes first the one whose most urgent job has the highest priority, where an owner who
// is not being served gains a point a minute; then who has fewer jobs running; then who was served longer
// ago; then the older job. So nobody waits for ever, neither a job of low priority nor an owner beside one
// who submits thousands.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/store/job_rows.h"

namespace server {

inline constexpr std::int64_t kPointMs = 60'000;  ///< of waiting, worth a point; the schema knows it too
/// A job may be overtaken by smaller ones while there is no room for it, until it has waited for so long.
inline constexpr std::int64_t kOvertakenMaxMs = 600'000;

/// The first job of an owner, and what its turn depends on.
struct Candidate {
  OwnerTurn owner;
  std::uint32_t most_urgent = 0;  ///< highest priority among the owner's queued jobs
  std::int64_t rank_ms = 0;       ///< of the first job
  std::int64_t queued_ms = 0;
  std::int64_t seq = 0;
};

std::int64_t rank_ms(const Waiting& job);

bool goes_before(const Candidate& a, const Candidate& b, std::int64_t now_ms);

/// The place of every queued job, 1 for the next, if nothing else came and each took as long as the others.
/// `waiting`: for each owner in the order in which its jobs are taken. -> by seq
std::map<std::int64_t, std::int64_t> queue_positions(const std::vector<Waiting>& waiting,
                                                     const std::vector<OwnerTurn>& turns,
                                                     std::int64_t now_ms);

}  // namespace server
