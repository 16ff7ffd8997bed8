// Jobs as clients watch and steer them.
#include <utility>

#include "server/http/conditions.h"
#include "server/http/field_text.h"
#include "server/http/job_json.h"
#include "server/http/parameters.h"
#include "server/http/problem.h"
#include "server/http/queue_routes.h"
#include "server/http/routes.h"

namespace server {
namespace {

constexpr std::int64_t kPageDefault = 50;
constexpr std::int64_t kPageMax = 200;
constexpr std::size_t kLabelFiltersMax = 8;

std::string state_names() {
  std::string names;
  for (const api::JobState state : api::kJobStates)
    names += (names.empty() ? "" : ", ") + std::string(api::name_of(state));
  return names;
}

/// "project" or "project:garage".
std::optional<LabelFilter> label_filter(std::string_view text) {
  const std::size_t colon = text.find(':');
  LabelFilter filter{std::string(text.substr(0, colon)), std::nullopt};
  if (!api::is_label_name(filter.name)) return std::nullopt;
  if (colon != text.npos) filter.value = text.substr(colon + 1);
  return filter;
}

/// What a list is to have, or why that cannot be read.
struct ListQuery {
  JobFilter filter;
  std::int64_t limit = kPageDefault;
  std::optional<HttpAnswer> refused = std::nullopt;
};

ListQuery read_list_query(const HttpRequest& request) {
  ListQuery query;
  const auto refuse = [&](std::string_view name, std::string_view code, const std::string& detail) {
    if (!query.refused) query.refused = bad_parameter(name, code, detail, request.path);
  };
  for (const auto& [name, value] : request.query) {
    if (name == "limit") {
      query.limit = whole_number(value).value_or(0);
      if (query.limit < 1 || query.limit > kPageMax)
        refuse(name, "out_of_range", "limit must be a whole number from 1 to " + std::to_string(kPageMax));
    } else if (name == "cursor") {
      query.filter.before_seq = whole_number(value);
      if (query.filter.before_seq.value_or(0) < 1)
        refuse(name, "unknown_value", "cursor is not one that a page has given");
    } else if (name == "state") {
      query.filter.state = api::job_state_named(value);
      if (!query.filter.state) refuse(name, "unknown_value", "state must be one of " + state_names());
    } else if (name == "owner") {
      query.filter.owner = value;
    } else if (name == "label") {
      const auto label = label_filter(value);
      if (label) query.filter.labels.push_back(*label);
      if (!label) refuse(name, "bad_name", "label must be NAME or NAME:VALUE");
      if (query.filter.labels.size() > kLabelFiltersMax)
        refuse(name, "too_many", "at most " + std::to_string(kLabelFiltersMax) + " labels can be asked for");
    }
  }
  return query;
}

/// The same request for the page that begins after `next` (RFC 8288).
std::string link_to_next(const HttpRequest& request, std::int64_t next) {
  std::string link = "<" + request.path + "?cursor=" + std::to_string(next);
  for (const auto& [name, value] : request.query)
    if (name != "cursor")
      link.append("&").append(percent_encoded(name)).append("=").append(percent_encoded(value));
  return link + ">; rel=\"next\"";
}

/// GET /v1/jobs, operationId listJobs.
HttpAnswer list_jobs(JobService& jobs, const HttpRequest& request) {
  ListQuery query = read_list_query(request);
  if (query.refused) return *query.refused;
  if (!request.sees_all) query.filter.visible_to = request.owner;
  const auto page = jobs.list(query.filter, query.limit);
  if (!page) return problem(page.error(), request.path);
  HttpAnswer answer = json_answer(job_page_json(*page, *jobs.queue_positions()));
  if (page->next) answer.headers.emplace_back("Link", link_to_next(request, *page->next));
  return answer;
}

HttpAnswer job_answer(JobService& jobs, const Job& job, int status) {
  const auto positions = jobs.queue_positions();
  HttpAnswer answer = json_answer(job_json(job, *positions), status);
  answer.etag = job_etag(job, *positions);
  return answer;
}

/// GET /v1/jobs/{id}, operationId getJob.
HttpAnswer get_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const auto job = jobs.job(values.at("id"));
  return job ? job_answer(jobs, *job, 200) : problem(job.error(), request.path);
}

/// The version that If-Match names, so that nothing in between is overwritten: of an entity tag "17-3"
/// the 17. `job` is what it is held against; none: it names another one.
std::optional<std::int64_t> matching_version(std::string_view if_match, const Job& job) {
  const std::string version = std::to_string(job.version);
  while (!if_match.empty()) {
    const std::string_view member = take_member(if_match);
    // If-Match compares strongly: a weak tag matches nothing (RFC 9110, section 13.1.1).
    if (member.starts_with("W/")) continue;
    const std::string_view tag = tag_in(member);
    if (tag == "*" || tag.substr(0, tag.find('-')) == version) return job.version;
  }
  return std::nullopt;
}

/// PATCH /v1/jobs/{id}, operationId changeJob.
HttpAnswer change_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const auto options = api::parse_job_options(request.body, "body");
  if (!options) return problem(options.error(), request.path);
  std::optional<std::int64_t> version;
  if (const auto if_match = request.header("If-Match")) {
    const auto job = jobs.job(values.at("id"));
    if (!job) return problem(job.error(), request.path);
    version = matching_version(*if_match, *job);
    if (!version)
      return problem({api::Fault::changed, "the job is at version " + std::to_string(job->version) +
                                               "; look at it again before you change it"},
                     request.path);
  }
  const auto changed = jobs.change(values.at("id"), *options, version);
  return changed ? job_answer(jobs, *changed, 200) : problem(changed.error(), request.path);
}

/// DELETE /v1/jobs/{id}, operationId deleteJob.
HttpAnswer delete_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const std::string dry_run = request.parameter("dry_run").value_or("false");
  if (dry_run != "true" && dry_run != "false")
    return bad_parameter("dry_run", "unknown_value", "dry_run must be true or false", request.path);
  const std::string& id = values.at("id");
  if (dry_run == "true") {
    const auto job = jobs.job(id);
    if (!job) return problem(job.error(), request.path);
    const auto removal = jobs.what_remove_deletes(id);
    return removal ? json_answer(removal_json(*job, *removal)) : problem(removal.error(), request.path);
  }
  const api::Status removed = jobs.remove(id);
  if (!removed) return problem(removed.error(), request.path);
  HttpAnswer answer;
  answer.status = 204;
  return answer;
}

/// POST /v1/jobs/{id}/retry, operationId retryJob.
HttpAnswer retry_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const std::string from = request.parameter("from").value_or("checkpoint");
  if (from != "checkpoint" && from != "start")
    return bad_parameter("from", "unknown_value", "from must be checkpoint or start", request.path);
  const auto job = jobs.retry(values.at("id"), from == "start");
  return job ? job_answer(jobs, *job, 202) : problem(job.error(), request.path);
}

/// POST /v1/jobs/{id}/cancel, pause, resume; operationIds cancelJob, pauseJob, resumeJob.
RouteHandler wish_handler(JobService& jobs, api::Result<Job> (JobService::*wish)(std::string_view)) {
  return [&jobs, wish](const HttpRequest& request, const PathValues& values) {
    const auto job = (jobs.*wish)(values.at("id"));
    return job ? job_answer(jobs, *job, 202) : problem(job.error(), request.path);
  };
}

}  // namespace

void add_job_routes(Router& router, JobService& jobs) {
  router.guard("id", [&jobs](const HttpRequest& request, const PathValues& values) {
    const api::Status seen = jobs.must_see(values.at("id"), viewer_of(request));
    return seen ? std::nullopt : std::optional(problem(seen.error(), request.path));
  });
  const auto with_jobs = [&jobs](auto handler) {
    return [&jobs, handler](const HttpRequest& request, const PathValues& values) {
      return handler(jobs, request, values);
    };
  };
  router.add("GET", "/v1/jobs",
             [&jobs](const auto& request, const auto&) { return list_jobs(jobs, request); });
  // Their bodies stream, to take_job; this is for requests that bring none.
  for (const std::string_view path : {kSubmitPath, kValidatePath, kPreviewPath})
    router.add("POST", std::string(path), [](const auto& request, const auto&) {
      return problem(411, "a body is expected here: multipart/form-data, or JSON that names files",
                     request.path);
    });
  router.add("GET", "/v1/jobs/{id}", with_jobs(get_job));
  router.add("PATCH", "/v1/jobs/{id}", with_jobs(change_job));
  router.add("DELETE", "/v1/jobs/{id}", with_jobs(delete_job));
  router.add("POST", "/v1/jobs/{id}/cancel", wish_handler(jobs, &JobService::cancel));
  router.add("POST", "/v1/jobs/{id}/pause", wish_handler(jobs, &JobService::pause));
  router.add("POST", "/v1/jobs/{id}/resume", wish_handler(jobs, &JobService::resume));
  router.add("POST", "/v1/jobs/{id}/retry", with_jobs(retry_job));
  add_queue_routes(router, jobs);
}

HttpAnswer json_answer(std::string body, int status) {
  HttpAnswer answer;
  answer.status = status;
  answer.content_type = "application/json";
  answer.body = std::move(body);
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

}  // namespace server
