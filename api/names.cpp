#include <array>

#include "api/job_status.h"
#include "api/progress_line.h"

namespace api {
namespace {

constexpr std::array<std::string_view, kJobStates.size()> kStateNames{
    "queued", "running", "pause_requested", "paused", "cancel_requested", "succeeded", "failed", "canceled"};

constexpr std::array<std::string_view, kJobEvents.size()> kEventNames{
    "claimed", "done", "gave_up", "interrupted", "cancel", "pause", "resume", "retry", "deadline_passed"};

constexpr std::array<std::string_view, 9> kStageNames{
    "scene", "patches", "estimate", "keyframes", "direct", "solve", "interpolate", "images", "publish"};

}  // namespace

std::string_view name_of(JobState state) {
  return kStateNames[static_cast<std::size_t>(state)];
}

std::optional<JobState> job_state_named(std::string_view name) {
  for (const JobState state : kJobStates)
    if (name_of(state) == name) return state;
  return std::nullopt;
}

std::string_view name_of(JobEvent event) {
  return kEventNames[static_cast<std::size_t>(event)];
}

std::optional<JobEvent> job_event_named(std::string_view name) {
  for (const JobEvent event : kJobEvents)
    if (name_of(event) == name) return event;
  return std::nullopt;
}

std::string_view name_of(Stage stage) {
  return kStageNames[static_cast<std::size_t>(stage)];
}

std::optional<Stage> stage_named(std::string_view name) {
  for (std::size_t i = 0; i < kStageNames.size(); ++i)
    if (kStageNames[i] == name) return static_cast<Stage>(i);
  return std::nullopt;
}

}  // namespace api
