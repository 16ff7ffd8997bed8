// Lines that a worker, taken over by a scene, appends to progress.ndjson; and its reports.
#include "api/progress_line.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "api/job_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (const auto line = api::parse_progress_line(bytes)) {
    // What is taken can be written and read again.
    if (!api::parse_progress_line(api::progress_line_json(*line))) std::abort();
  }
  (void)static_cast<bool>(api::parse_job_report(bytes));
  (void)static_cast<bool>(api::parse_key_frame_report(bytes));
  return 0;
}
