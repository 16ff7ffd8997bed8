#include "server/http/result_answers.h"

#include <algorithm>
#include <utility>

#include "server/http/parameters.h"
#include "server/http/problem.h"

namespace server {
namespace {

constexpr std::size_t kStemMax = 48;

bool is_safe(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '_' ||
         c == '-';
}

/// Other characters, as many as follow each other, become one '-'.
std::string safe(std::string_view text) {
  std::string name;
  for (const char c : text)
    if (is_safe(c))
      name += c;
    else if (!name.ends_with('-'))
      name += '-';
  return name;
}

/// The job's name as the beginning of a file's; its id where nothing of that is left.
std::string stem_of(const Job& job) {
  std::string stem = safe(job.settings.name).substr(0, kStemMax);
  const auto begin = stem.find_first_not_of("-.");
  if (begin == stem.npos) return job.id;
  return stem.substr(begin, stem.find_last_not_of("-.") + 1 - begin);
}

int digit_of(char c) {
  return c <= '9' ? c - '0' : c - 'a' + 10;
}

std::string base64_of_hex(std::string_view hex) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned bits = 0;
  int count = 0;
  for (const char c : hex) {
    bits = bits << 4 | static_cast<unsigned>(digit_of(c));
    for (count += 4; count >= 6; count -= 6) out += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) out += kDigits[bits << (6 - count) & 63];
  out.append((4 - out.size() % 4) % 4, '=');
  return out;
}

bool is_shown(std::string_view type) {
  return type.starts_with("image/png") || type.starts_with("image/jpeg") || type.starts_with("video/") ||
         type.starts_with("application/json") || type.starts_with("text/");
}

/// images/front/0007.png -> front-0007.png
std::string download_name(std::string_view path) {
  if (path.starts_with("images/")) path.remove_prefix(7);
  std::string name(path);
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

}  // namespace

void add_job_route(Router& router, JobService& jobs, std::string method, std::string pattern,
                   JobHandler handler) {
  router.add(std::move(method), std::move(pattern),
             [&jobs, handler = std::move(handler)](const HttpRequest& request, const PathValues& values) {
               const auto job = jobs.job(values.at("id"));
               if (!job) return problem(job.error(), request.path);
               jobs.use(*job);
               HttpAnswer answer = handler(jobs, *job, request, values);
               if (answer.status != 500) return answer;
               // Removed while it was looked at: that its files were missing is no failure of ours.
               const auto still = jobs.job(job->id);
               return still ? answer : problem(still.error(), request.path);
             });
}

HttpAnswer file_answer(FileBody body, std::string content_type, std::string etag) {
  HttpAnswer answer;
  answer.content_type = std::move(content_type);
  answer.file = std::make_shared<FileBody>(std::move(body));
  answer.etag = std::move(etag);
  answer.ranges = true;
  return answer;
}

HttpAnswer made_answer(std::function<std::int64_t(std::int64_t, char*, std::int64_t)> made,
                       std::int64_t bytes, std::string content_type, std::string etag) {
  HttpAnswer answer =
      file_answer({{}, {}, 0, bytes, std::move(made)}, std::move(content_type), std::move(etag));
  answer.headers.emplace_back("Cache-Control", kForever);
  return answer;
}

void name_download(HttpAnswer& answer, const Job& job, std::string_view file) {
  const std::string kind = is_shown(answer.content_type) ? "inline" : "attachment";
  answer.headers.emplace_back("Content-Disposition",
                              kind + "; filename=\"" + stem_of(job) + "-" + safe(file) + "\"");
}

void add_digest(HttpAnswer& answer, std::string_view sha256) {
  answer.headers.emplace_back("Repr-Digest", "sha-256=:" + base64_of_hex(sha256) + ":");
}

HttpAnswer artefact_answer_as(JobService& jobs, const Job& job, const HttpRequest& request,
                              std::string_view path, std::string_view file) {
  const auto artefact = jobs.artefact(job, path);
  if (!artefact) return problem(artefact.error(), request.path);
  auto opened = open_below(jobs.folder_of(job) / "artefacts", artefact->path);
  if (!opened) return problem({api::Fault::internal, opened.error().message}, request.path);
  HttpAnswer answer =
      file_answer({std::move(*opened), {}, 0, artefact->bytes}, artefact->media_type, artefact->sha256);
  answer.headers.emplace_back("Cache-Control", kForever);
  add_digest(answer, artefact->sha256);
  name_download(answer, job, file);
  return answer;
}

HttpAnswer artefact_answer(JobService& jobs, const Job& job, const HttpRequest& request,
                           std::string_view path) {
  return artefact_answer_as(jobs, job, request, path, download_name(path));
}

std::optional<std::uint64_t> whole_number_up_to(std::string_view digits, std::uint64_t most) {
  const auto value = whole_number(digits);
  if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > most) return std::nullopt;
  return static_cast<std::uint64_t>(*value);
}

api::Result<std::uint32_t> frame_of(const Job& job, const PathValues& values) {
  if (const auto frame = whole_number_up_to(values.at("f"), job.frame_count - 1))
    return static_cast<std::uint32_t>(*frame);
  return api::Error{api::Fault::not_found,
                    "the job has the frames 0 to " + std::to_string(job.frame_count - 1)};
}

api::Status must_have_results(const Job& job) {
  if (job.state == api::JobState::succeeded) return api::Done{};
  return api::Error{api::Fault::not_found,
                    "not made yet: the job is " + std::string(api::name_of(job.state))};
}

}  // namespace server
