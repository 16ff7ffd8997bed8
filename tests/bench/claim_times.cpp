// claim_times DATA COUNT: claims jobs of the queue that a server left there, and says how long each took.
// Beside every claim one commit that changes a single number, so that the disk of that moment is known.
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "server/artefacts/data_folder.h"
#include "server/jobs/job_service.h"
#include "server/store/job_store.h"

namespace {

template <class Act>
double milliseconds_of(Act act) {
  const auto begun = std::chrono::steady_clock::now();
  act();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
}

int fail(std::string_view why) {
  std::cerr << "claim_times: " << why << "\n";
  return 1;
}

void print(std::string_view name, const std::vector<double>& values) {
  std::cout << "\"" << name << "\": [";
  for (std::size_t i = 0; i < values.size(); ++i) std::cout << (i > 0 ? ", " : "") << values[i];
  std::cout << "]";
}

int run(const std::filesystem::path& data, int count) {
  const auto folder = server::DataFolder::open(data);
  if (!folder) return fail(folder.error().message);
  const auto store = server::JobStore::open(folder->database());
  if (!store) return fail(store.error().message);
  if (const auto resumed = (*store)->set_queue(false, ""); !resumed) return fail(resumed.error().message);
  server::JobService jobs(**store, *folder, {});
  std::vector<double> claims, commits;
  for (int i = 0; i < count; ++i) {
    std::int64_t seq = 0;
    claims.push_back(milliseconds_of([&] {
      if (const auto claim = jobs.claim(); claim && *claim) seq = (*claim)->lease.job_seq;
    }));
    if (seq == 0) return fail("there is nothing to claim");
    bool written = false;
    commits.push_back(milliseconds_of([&] { written = bool((*store)->record_bytes(seq, i)); }));
    if (!written) return fail("nothing can be written");
  }
  std::cout << "{";
  print("claims_ms", claims);
  std::cout << ", ";
  print("commits_ms", commits);
  std::cout << "}\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc == 3 ? std::atoi(argv[2]) : 0;
  if (count < 1) return fail("usage: claim_times DATA COUNT");
  return run(argv[1], count);
}
