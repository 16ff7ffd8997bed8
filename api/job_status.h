// The states of a job, what can happen to it in each, and the steps between them; what the server keeps and
// shows of it.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace api {

enum class JobState {
  queued,
  running,
  pause_requested,
  paused,
  cancel_requested,
  succeeded,
  failed,
  canceled
};

inline constexpr std::array kJobStates{
    JobState::queued,           JobState::running,   JobState::pause_requested, JobState::paused,
    JobState::cancel_requested, JobState::succeeded, JobState::failed,          JobState::canceled};

std::string_view name_of(JobState state);
std::optional<JobState> job_state_named(std::string_view name);

/// What can happen to a job.
enum class JobEvent {
  claimed,      ///< a worker takes it
  done,         ///< the worker is dead and all artefacts are published
  gave_up,      ///< the worker is dead and no other attempt is to follow
  interrupted,  ///< the worker is dead: crashed, told to stop, or lost with the server
  cancel,       ///< a client's wish, as the next three
  pause,
  resume,
  retry,
  deadline_passed,  ///< before it was started, or started anew
};

inline constexpr std::array kJobEvents{JobEvent::claimed,     JobEvent::done,   JobEvent::gave_up,
                                       JobEvent::interrupted, JobEvent::cancel, JobEvent::pause,
                                       JobEvent::resume,      JobEvent::retry,  JobEvent::deadline_passed};

/// "pause"
std::string_view name_of(JobEvent event);
std::optional<JobEvent> job_event_named(std::string_view name);

struct JobReaction {
  JobState from;
  JobEvent event;
  JobState to;  ///< the same state: a wish that is fulfilled already, its repetition is no error
};

/// Everything that may happen. What is not here is a wrong state.
inline constexpr std::array kJobReactions{
    JobReaction{JobState::queued, JobEvent::claimed, JobState::running},
    JobReaction{JobState::queued, JobEvent::cancel, JobState::canceled},
    JobReaction{JobState::queued, JobEvent::pause, JobState::paused},
    JobReaction{JobState::queued, JobEvent::resume, JobState::queued},
    JobReaction{JobState::queued, JobEvent::retry, JobState::queued},
    JobReaction{JobState::queued, JobEvent::deadline_passed, JobState::failed},
    JobReaction{JobState::running, JobEvent::done, JobState::succeeded},
    JobReaction{JobState::running, JobEvent::gave_up, JobState::failed},
    JobReaction{JobState::running, JobEvent::interrupted, JobState::queued},
    JobReaction{JobState::running, JobEvent::cancel, JobState::cancel_requested},
    JobReaction{JobState::running, JobEvent::pause, JobState::pause_requested},
    // The wish may come when the worker has begun already.
    JobReaction{JobState::running, JobEvent::resume, JobState::running},
    JobReaction{JobState::running, JobEvent::retry, JobState::running},
    // A job that is done after all needs no pause.
    JobReaction{JobState::pause_requested, JobEvent::done, JobState::succeeded},
    JobReaction{JobState::pause_requested, JobEvent::gave_up, JobState::failed},
    JobReaction{JobState::pause_requested, JobEvent::interrupted, JobState::paused},
    JobReaction{JobState::pause_requested, JobEvent::cancel, JobState::cancel_requested},
    JobReaction{JobState::pause_requested, JobEvent::pause, JobState::pause_requested},
    JobReaction{JobState::paused, JobEvent::cancel, JobState::canceled},
    JobReaction{JobState::paused, JobEvent::pause, JobState::paused},
    JobReaction{JobState::paused, JobEvent::resume, JobState::queued},
    JobReaction{JobState::paused, JobEvent::deadline_passed, JobState::failed},
    // A wish to cancel wins over every outcome.
    JobReaction{JobState::cancel_requested, JobEvent::done, JobState::canceled},
    JobReaction{JobState::cancel_requested, JobEvent::gave_up, JobState::canceled},
    JobReaction{JobState::cancel_requested, JobEvent::interrupted, JobState::canceled},
    JobReaction{JobState::cancel_requested, JobEvent::cancel, JobState::cancel_requested},
    JobReaction{JobState::canceled, JobEvent::cancel, JobState::canceled},
    JobReaction{JobState::canceled, JobEvent::retry, JobState::queued},
    JobReaction{JobState::failed, JobEvent::retry, JobState::queued},
};

/// The state that `event` leads to; none: it cannot happen in this state.
constexpr std::optional<JobState> after(JobState from, JobEvent event) {
  for (const JobReaction& reaction : kJobReactions)
    if (reaction.from == from && reaction.event == event) return reaction.to;
  return std::nullopt;
}

/// Does anything lead from the one state to the other?
constexpr bool may_step(JobState from, JobState to) {
  for (const JobReaction& reaction : kJobReactions)
    if (reaction.from == from && reaction.to == to && from != to) return true;
  return false;
}

constexpr bool is_final(JobState state) {
  return state == JobState::succeeded || state == JobState::failed || state == JobState::canceled;
}

/// Is a worker at it?
constexpr bool has_worker(JobState state) {
  return state == JobState::running || state == JobState::pause_requested ||
         state == JobState::cancel_requested;
}

static_assert(!may_step(JobState::queued, JobState::succeeded), "nothing succeeds without running");
static_assert(!after(JobState::succeeded, JobEvent::retry), "what has succeeded stays as it is");

}  // namespace api
