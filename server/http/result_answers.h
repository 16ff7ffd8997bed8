// What the routes of results have in common: the job in the path, files with their hash, safe names.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "server/http/message.h"
#include "server/http/router.h"
#include "server/jobs/job_service.h"

namespace server {

/// What a job has made never changes under its name.
inline constexpr const char* kForever = "private, max-age=31536000, immutable";

/// A handler for a job that must exist.
using JobHandler = std::function<HttpAnswer(JobService&, const Job&, const HttpRequest&, const PathValues&)>;

/// `pattern` has an {id}: 404 where there is no such job.
void add_job_route(Router& router, JobService& jobs, std::string method, std::string pattern,
                   JobHandler handler);

/// A file of the job with its ETag, Repr-Digest (RFC 9530) and a name to save it under; the problem where
/// there is none, also because the job is not done.
HttpAnswer artefact_answer(JobService& jobs, const Job& job, const HttpRequest& request,
                           std::string_view path);
/// The same, saved under `file` after the job's name.
HttpAnswer artefact_answer_as(JobService& jobs, const Job& job, const HttpRequest& request,
                              std::string_view path, std::string_view file);

/// Bytes that are made up as they are read.
HttpAnswer made_answer(std::function<std::int64_t(std::int64_t, char*, std::int64_t)> made,
                       std::int64_t bytes, std::string content_type, std::string etag);
HttpAnswer file_answer(FileBody body, std::string content_type, std::string etag);

/// Content-Disposition: "attachment" or, for what a browser can show, "inline"; the job's name and `file`,
/// of which only letters, digits, '.', '_' and '-' stay.
void name_download(HttpAnswer& answer, const Job& job, std::string_view file);

/// Repr-Digest of the whole, from its SHA-256 in hexadecimal.
void add_digest(HttpAnswer& answer, std::string_view sha256);

/// The frame in the path, if the job has it.
api::Result<std::uint32_t> frame_of(const Job& job, const PathValues& values);

/// Not_found, saying in which state it is, unless it has succeeded.
api::Status must_have_results(const Job& job);

/// Digits alone, no more than `most`.
std::optional<std::uint64_t> whole_number_up_to(std::string_view digits, std::uint64_t most);

}  // namespace server
