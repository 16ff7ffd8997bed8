// The part of JobService that knows whether a job's inputs are what came in.
#include <algorithm>

#include "server/jobs/job_service.h"

namespace server {
namespace {

constexpr std::int64_t kReadBytesMax = 256 << 20;

}  // namespace

api::Status JobService::must_have_whole_inputs(const Job& job) {
  auto inputs = store_.inputs(job.seq);
  if (!inputs) return inputs.error();
  std::sort(inputs->begin(), inputs->end(),
            [](const InputFile& a, const InputFile& b) { return a.bytes < b.bytes; });
  std::int64_t left = kReadBytesMax;
  for (const InputFile& input : *inputs) {
    if (input.sha256.empty()) continue;
    const ClaimedFile claimed{input.name, input.bytes, input.sha256, "input"};
    left -= input.bytes;
    const std::filesystem::path folder = folder_.job(job.id) / "input";
    if (api::Status same = left >= 0 ? verify_file(folder, claimed) : verify_size(folder, claimed); !same)
      return same;
  }
  return api::Done{};
}

}  // namespace server
