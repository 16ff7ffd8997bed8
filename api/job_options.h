// What a client says about a job besides what is to be rendered: when it is submitted, and later.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"

namespace api {

inline constexpr std::uint32_t kPriorityMax = 100, kPriorityDefault = 50;
inline constexpr std::size_t kLabelsMax = 16, kLabelNameBytesMax = 64, kLabelValueBytesMax = 200;
inline constexpr std::size_t kJobOptionsBytesMax = 64 * 1024;
inline constexpr std::uint64_t kRunSecondsMax = 366 * 24 * 3600, kTtlSecondsMax = 10 * kRunSecondsMax;

using Labels = std::map<std::string, std::string>;  ///< name -> value

/// A setting that can also be taken away.
template <class T>
struct Setting {
  bool given = false;
  std::optional<T> value = std::nullopt;  ///< none: null was given
};

/// Only what was given; the rest is as it was, or the default.
struct JobOptions {
  std::optional<std::string> name;        ///< at most 200 bytes, printable; default: the animation's
  std::optional<std::uint32_t> priority;  ///< 0 .. kPriorityMax; a point is worth a minute of waiting
  std::optional<Labels> labels;           ///< in place of all there were
  /// Not started or not done by then: failed. [ms since 1970, UTC]
  Setting<std::int64_t> deadline_ms = {};
  Setting<std::uint64_t> max_run_seconds = {};  ///< 1 .. kRunSecondsMax, all attempts together
  Setting<std::uint64_t> ttl_seconds = {};      ///< 0 .. kTtlSecondsMax after it finished: removed
  std::optional<bool> pinned;                   ///< never removed by itself
};

/// Letters, digits, '_', '-', '.', at most kLabelNameBytesMax of them.
bool is_label_name(std::string_view name);

/// {"name": "garage", "priority": 80, "labels": {"project": "a"}, "deadline": "2026-11-22T08:15:30Z",
///  "max_run_seconds": 3600, "ttl_seconds": null, "pinned": true}: api/schemas/job_options.schema.json.
/// Errors: all violations, naming `file`. Defined in api/json/.
Result<JobOptions> parse_job_options(std::string_view bytes, std::string_view file = "options");

/// "2026-11-22T08:15:30.123Z" and other offsets (RFC 3339, years 1970 to 9999) -> ms since 1970; none: no
/// such time.
std::optional<std::int64_t> parse_time(std::string_view text);

/// What is to be done with several jobs at once.
struct JobBatch {
  std::vector<std::string> ids;
  std::string action;  ///< cancel, pause, resume, retry, delete
};

inline constexpr std::size_t kBatchMax = 200;

/// {"ids": ["job_..."], "action": "cancel"}. Errors: all violations.
Result<JobBatch> parse_job_batch(std::string_view bytes, std::string_view file = "body");

}  // namespace api
