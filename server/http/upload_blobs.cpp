#include "server/http/upload_blobs.h"

#include <unistd.h>

#include <array>
#include <cerrno>

#include "api/job_files.h"
#include "server/http/problem.h"

namespace server {
namespace {

constexpr std::size_t kHashedPieceBytes = 64 * 1024;

api::Error unknown_blob(std::size_t index, const api::JobFile& file) {
  const std::string detail =
      "there is no blob " + file.sha256 + "; send it with PUT /v1/blobs/sha256/" + file.sha256;
  return {api::Fault::invalid_request,
          detail,
          {{"body", "/files/" + std::to_string(index) + "/sha256", 0, 0, "unknown_blob", detail}}};
}

/// Room for all of it at once: a job may name one large blob many times.
std::optional<HttpAnswer> reserve_room(const HttpRequest& request, JobService& jobs,
                                       const std::vector<api::JobFile>& files, UploadReceiver& receiver) {
  std::int64_t bytes = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto blob = jobs.open_blob(request.owner, files[i].sha256);
    if (!blob && blob.error().fault != api::Fault::not_found) return problem(blob.error(), request.path);
    if (!blob) return problem(unknown_blob(i, files[i]), request.path);
    const auto size = size_of(*blob);
    if (!size) return problem(size.error(), request.path);
    bytes += *size;
  }
  (void)receiver.reserve(bytes);
  return std::nullopt;
}

/// False: the receiver has had enough, or the file cannot be read.
bool hand_over(const FileHandle& file, UploadReceiver& receiver, int& read_error) {
  std::array<char, kHashedPieceBytes> piece;
  for (;;) {
    const ssize_t count = ::read(file.get(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) read_error = errno;
    if (count <= 0) return count == 0;
    if (!receiver.take({piece.data(), static_cast<std::size_t>(count)})) return false;
  }
}

}  // namespace

bool is_json(const HttpRequest& request) {
  const std::string type = request.header("Content-Type").value_or("");
  return type.substr(0, type.find(';')) == "application/json";
}

std::optional<HttpAnswer> receive_named_files(const HttpRequest& request, const ReadBody& read_body,
                                              JobService& jobs, UploadReceiver& receiver) {
  std::string body;
  const bool whole = read_body([&](std::string_view bytes) {
    body += bytes;
    return body.size() <= api::kJobFilesBytesMax;
  });
  if (body.size() > api::kJobFilesBytesMax)
    return problem(413,
                   "the list of files is larger than " + std::to_string(api::kJobFilesBytesMax) + " bytes",
                   request.path);
  if (!whole) return problem(400, "the body ended early", request.path);
  const auto job = api::parse_job_files(body);
  if (!job) return problem(job.error(), request.path);
  if (!job->options.empty() &&
      (!receiver.begin_part("options", "options.json") || !receiver.take(job->options)))
    return std::nullopt;
  if (auto refused = reserve_room(request, jobs, job->files, receiver)) return refused;
  for (std::size_t i = 0; i < job->files.size(); ++i) {
    const api::JobFile& file = job->files[i];
    const auto blob = jobs.open_blob(request.owner, file.sha256);
    if (!blob && blob.error().fault != api::Fault::not_found) return problem(blob.error(), request.path);
    if (!blob) return problem(unknown_blob(i, file), request.path);
    int read_error = 0;
    const bool taken = receiver.begin_part(file.field, file.name.empty() ? file.field : file.name) &&
                       hand_over(*blob, receiver, read_error);
    if (read_error != 0) return problem(file_error("read a blob", read_error), request.path);
    if (!taken) return std::nullopt;
    const auto sha256 = receiver.end_part();
    if (!sha256) return std::nullopt;
    if (*sha256 != file.sha256) {  // the disk forgets: whoever sends it again has it whole again
      if (const api::Status dropped = jobs.drop_blob(file.sha256); !dropped)
        return problem(dropped.error(), request.path);
      return problem(unknown_blob(i, file), request.path);
    }
  }
  return std::nullopt;
}

}  // namespace server
