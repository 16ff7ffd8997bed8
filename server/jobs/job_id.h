// Names of jobs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace server {

/// "job_" and 26 characters of Crockford's base 32: 10 of the time in milliseconds, so that names sort by
/// age, and 16 (80 bits) from the kernel's random source, so that nobody guesses another's job. Layout as
/// ULID, https://github.com/ulid/spec.
std::string new_job_id(std::int64_t now_ms);

/// Could `id` be a job's name? Says nothing about whether the job exists.
bool is_job_id(std::string_view id);

}  // namespace server
