#include "server/store/turns.h"

#include <algorithm>
#include <tuple>

namespace server {
namespace {

std::int64_t points(const Candidate& candidate, std::int64_t now_ms) {
  // Who is being served gains nothing: otherwise whoever came first with a thousand jobs would stay ahead.
  if (candidate.owner.running > 0) return candidate.most_urgent;
  const std::int64_t since_ms = std::max(candidate.queued_ms, candidate.owner.started_ms);
  return candidate.most_urgent + std::max<std::int64_t>(0, now_ms - since_ms) / kPointMs;
}

/// The jobs of one owner that have no place yet.
struct Line {
  OwnerTurn owner;
  std::vector<Waiting> jobs;
  std::vector<std::uint32_t> most_urgent;  ///< from each job to the end
  std::size_t next = 0;

  Candidate candidate() const {
    const Waiting& job = jobs[next];
    return {owner, most_urgent[next], rank_ms(job), job.queued_ms, job.seq};
  }
};

std::map<std::string, Line> lines_of(const std::vector<Waiting>& waiting,
                                     const std::vector<OwnerTurn>& turns) {
  std::map<std::string, Line> lines;
  Line* last = nullptr;  // the jobs of an owner come together
  for (const Waiting& job : waiting) {
    if (last == nullptr || last->jobs.front().owner != job.owner) last = &lines[job.owner];
    last->jobs.push_back(job);
  }
  for (auto& [owner, line] : lines) {
    line.owner.owner = owner;
    line.most_urgent.resize(line.jobs.size());
    std::uint32_t most = 0;
    for (std::size_t i = line.jobs.size(); i-- > 0;)
      line.most_urgent[i] = most = std::max(most, line.jobs[i].priority);
  }
  for (const OwnerTurn& turn : turns)
    if (const auto line = lines.find(turn.owner); line != lines.end()) line->second.owner = turn;
  return lines;
}

}  // namespace

std::int64_t rank_ms(const Waiting& job) {
  return job.queued_ms - job.priority * kPointMs;
}

bool goes_before(const Candidate& a, const Candidate& b, std::int64_t now_ms) {
  const auto key = [&](const Candidate& c) {
    return std::tuple(-points(c, now_ms), c.owner.running, c.owner.started_ms, c.rank_ms, c.seq);
  };
  return key(a) < key(b);
}

std::map<std::int64_t, std::int64_t> queue_positions(const std::vector<Waiting>& waiting,
                                                     const std::vector<OwnerTurn>& turns,
                                                     std::int64_t now_ms) {
  std::map<std::string, Line> lines = lines_of(waiting, turns);
  std::vector<Line*> heap;
  for (auto& [owner, line] : lines) heap.push_back(&line);
  const auto goes_after = [&](const Line* a, const Line* b) {
    return goes_before(b->candidate(), a->candidate(), now_ms);
  };
  std::make_heap(heap.begin(), heap.end(), goes_after);
  std::map<std::int64_t, std::int64_t> positions;
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), goes_after);
    Line& line = *heap.back();
    positions.emplace_hint(positions.end(), line.jobs[line.next].seq,
                           static_cast<std::int64_t>(positions.size()) + 1);
    ++line.owner.running;  // as if it ran now: the others' turn comes first
    if (++line.next == line.jobs.size())
      heap.pop_back();
    else
      std::push_heap(heap.begin(), heap.end(), goes_after);
  }
  return positions;
}

}  // namespace server
