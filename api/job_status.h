// The states of a job and the steps allowed between them; what the server keeps and shows of it.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace api {

enum class JobState { queued, running, cancel_requested, succeeded, failed, canceled };

inline constexpr std::array kJobStates{JobState::queued,    JobState::running, JobState::cancel_requested,
                                       JobState::succeeded, JobState::failed,  JobState::canceled};

std::string_view name_of(JobState state);
std::optional<JobState> job_state_named(std::string_view name);

struct JobStep {
  JobState from;
  JobState to;
};

inline constexpr std::array kJobSteps{
    JobStep{JobState::queued, JobState::running},     // a worker took it
    JobStep{JobState::queued, JobState::canceled},    // canceled before it began
    JobStep{JobState::running, JobState::succeeded},  // all artefacts published
    JobStep{JobState::running, JobState::failed},     // refused by the worker, or too many lost attempts
    JobStep{JobState::running, JobState::queued},     // worker or server lost: one more attempt
    JobStep{JobState::running, JobState::cancel_requested},   // told to stop
    JobStep{JobState::cancel_requested, JobState::canceled},  // the worker is dead
};

constexpr bool may_step(JobState from, JobState to) {
  for (const JobStep& step : kJobSteps)
    if (step.from == from && step.to == to) return true;
  return false;
}

constexpr bool is_final(JobState state) {
  return state == JobState::succeeded || state == JobState::failed || state == JobState::canceled;
}

static_assert(!may_step(JobState::queued, JobState::succeeded), "nothing succeeds without running");

}  // namespace api
