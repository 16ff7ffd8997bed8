#include "server/jobs/submission_keys.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/artefacts/verify.h"
#include "server/jobs/job_service.h"

namespace server {
namespace {

constexpr std::size_t kKeyBytesMax = 255;

/// Of what was uploaded, however it came in: the boundary of a multipart body differs each time.
api::Result<std::string> digest_of(const Upload& upload, const std::filesystem::path& input_folder) {
  std::vector<InputFile> inputs = upload.inputs;
  std::sort(inputs.begin(), inputs.end(),
            [](const InputFile& a, const InputFile& b) { return a.name < b.name; });
  std::string list;
  for (const InputFile& input : inputs) {
    std::string sha256 = input.sha256;
    if (sha256.empty()) {
      const auto file = open_below(input_folder, input.name);
      if (!file) return file.error();
      const auto read = sha256_of(*file);
      if (!read) return read.error();
      sha256 = *read;
    }
    list += sha256 + " " + std::to_string(static_cast<int>(input.role)) + " " + input.name + "\n";
  }
  return sha256_of(list + upload.options);
}

}  // namespace

HeldKey::~HeldKey() {
  if (!shared_) return;
  const std::lock_guard lock(shared_->mutex);
  shared_->held.erase(key_);
}

std::optional<HeldKey> SubmissionKeys::hold(std::string_view owner, std::string_view key) {
  HeldKey::Keys::value_type pair{owner, key};
  const std::lock_guard lock(shared_->mutex);
  if (!shared_->held.insert(pair).second) return std::nullopt;
  return std::optional<HeldKey>(std::in_place, shared_, std::move(pair));
}

bool is_idempotency_key(std::string_view text) {
  return !text.empty() && text.size() <= kKeyBytesMax &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

api::Result<Submitted> JobService::submit(const Upload& upload, const HeldKey& key) {
  const auto refused = [&](const api::Error& error) {
    discard(upload);
    return error;
  };
  const auto digest = digest_of(upload, folder_.upload(upload.id) / "input");
  if (!digest) return refused(digest.error());
  const std::int64_t since_ms = clock_() - rules_.key_ms;
  auto earlier = store_.job_of_key(key.owner(), key.key(), since_ms);
  if (!earlier) return refused(earlier.error());
  if (*earlier) {
    discard(upload);
    if ((*earlier)->request_sha256 == *digest) return Submitted{std::move((*earlier)->job), true};
    const std::string detail =
        "the key belongs to another submission, " + (*earlier)->job.id + "; a new job needs a new key";
    return api::Error{
        api::Fault::invalid_request, detail, {{"Idempotency-Key", "", 0, 0, "reused_key", detail}}};
  }
  // So that a key which is too old to count does not stand in the way.
  if (const api::Status forgotten = store_.forget_keys(since_ms); !forgotten)
    return refused(forgotten.error());
  auto job = submit(upload, IdempotencyKey{key.key(), *digest});
  if (!job) return job.error();
  return Submitted{std::move(*job), false};
}

}  // namespace server
