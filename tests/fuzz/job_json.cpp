// animation.json and the options of a submission.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "api/job_options.h"
#include "api/job_request.h"
#include "api/read_request.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const api::ReadRequest read = api::read_request(bytes);
  const auto parsed = api::parse_job_request(bytes);
  // Both ways to read tell the same, and a refusal says why.
  if (static_cast<bool>(parsed) != read.violations.empty()) std::abort();
  if (!parsed && parsed.error().violations.size() > api::kViolationsMax) std::abort();
  (void)static_cast<bool>(api::parse_job_options(bytes));
  (void)static_cast<bool>(api::parse_job_batch(bytes));
  return 0;
}
