// PUT, GET and HEAD of /v1/blobs/sha256/{hex}: files by what they hold, for jobs to name.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "api/job_files.h"
#include "api/json/json_text.h"
#include "server/http/parameters.h"
#include "server/http/problem.h"
#include "server/http/routes.h"
#include "server/http/upload_blobs.h"
#include "server/jobs/job_id.h"

namespace server {
namespace {

HttpAnswer blob_answer(const HttpRequest& request, const std::string& hash, int status) {
  HttpAnswer answer = json_answer(api::json_text({{"sha256", hash}}), status);
  if (status == 201) answer.headers.emplace_back("Location", request.path);
  return answer;
}

HttpAnswer bad_hash(const HttpRequest& request) {
  return bad_parameter("hex", "bad_hash", "a SHA-256 is 64 lower-case hexadecimal digits", request.path);
}

/// GET and HEAD, operationId getBlob. What it holds is not given back: knowing a hash is not owning a file.
/// Only who has sent it learns that it is here.
HttpAnswer get_blob(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const std::string& hash = values.at("hex");
  if (!api::is_sha256(hash)) return bad_hash(request);
  const auto file = jobs.open_blob(request.owner, hash);
  return file ? blob_answer(request, hash, 200) : problem(file.error(), request.path);
}

std::optional<HttpAnswer> refuse_blob_early(const HttpRequest& request, JobService& jobs,
                                            const DataFolder& folder, const UploadLimits& limits) {
  if (request.header("Content-Encoding"))
    return problem(415, "compressed uploads are not taken", request.path);
  const std::int64_t bytes = whole_number(request.header("Content-Length").value_or("")).value_or(0);
  if (bytes > limits.total_bytes)
    return problem(413, "a blob is at most " + std::to_string(limits.total_bytes) + " bytes", request.path);
  if (const api::Status room = RoomClaim(folder.room()).reserve(bytes); !room)
    return problem(room.error(), request.path);
  if (const api::Status room = jobs.within_quota(request.owner, bytes); !room)
    return problem(room.error(), request.path);
  return std::nullopt;
}

/// A file in tmp/ that goes unless it has been moved.
class TemporaryFile {
 public:
  explicit TemporaryFile(const DataFolder& folder)
      : path_(folder.upload("blob_" + new_job_id(system_clock_ms()))),
        file_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600)) {}
  ~TemporaryFile() { ::unlink(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const FileHandle& file() const { return file_; }

 private:
  const std::filesystem::path path_;
  const FileHandle file_;
};

/// PUT, operationId putBlob.
HttpAnswer put_blob(JobService& jobs, const DataFolder& folder, const UploadLimits& limits,
                    const HttpRequest& request, const std::string& hash, const ReadBody& read_body) {
  if (!api::is_sha256(hash)) return bad_hash(request);
  if (jobs.open_blob(request.owner, hash)) return blob_answer(request, hash, 200);
  const TemporaryFile temporary(folder);
  if (!temporary.file()) return problem(file_error("keep a blob", errno), request.path);
  std::int64_t bytes = 0;
  RoomClaim room(folder.room());
  api::Status written = room.reserve(whole_number(request.header("Content-Length").value_or("")).value_or(0));
  if (!written) return problem(written.error(), request.path);
  const bool whole = read_body([&](std::string_view piece) {
    bytes += static_cast<std::int64_t>(piece.size());
    if (bytes > limits.total_bytes) return false;
    written = room.make_sure_of(static_cast<std::int64_t>(piece.size()));
    if (written) written = write_all(temporary.file(), piece);
    if (written) room.wrote(static_cast<std::int64_t>(piece.size()));
    return static_cast<bool>(written);
  });
  if (bytes > limits.total_bytes)
    return problem(413, "a blob is at most " + std::to_string(limits.total_bytes) + " bytes", request.path);
  if (!written) return problem(written.error(), request.path);
  if (!whole) return problem(400, "the blob ended early", request.path);
  const api::Status kept = jobs.keep_blob(request.owner, temporary.path(), hash);
  return kept ? blob_answer(request, hash, 201) : problem(kept.error(), request.path);
}

}  // namespace

void add_blob_routes(Router& router, JobService& jobs, const DataFolder& folder, const UploadLimits& limits) {
  const std::string pattern = "/v1/blobs/sha256/{hex}";
  router.add("GET", pattern,
             [&jobs](const auto& request, const auto& values) { return get_blob(jobs, request, values); });
  router.add_upload(
      "PUT", pattern,
      [&jobs, &folder, limits](const HttpRequest& request, const PathValues& values, const ReadBody& body) {
        return put_blob(jobs, folder, limits, request, values.at("hex"), body);
      },
      [&jobs, &folder, limits](const HttpRequest& request) {
        return refuse_blob_early(request, jobs, folder, limits);
      });
}

}  // namespace server
