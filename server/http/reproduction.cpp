#include "server/http/reproduction.h"

#include <malloc.h>

#include <mutex>
#include <optional>
#include <utility>

#include "api/job_report.h"
#include "api/job_request.h"
#include "api/json/json_text.h"
#include "server/artefacts/verify.h"
#include "server/http/result_answers.h"

namespace server {
namespace {

using api::Json;

struct Lighting {
  Json as_given;
  std::uint64_t seed = 1;
};

// A small file can become a large document: one at a time, and its memory is given back.
api::Result<Lighting> lighting_of(const std::filesystem::path& input) {
  static std::mutex parsing;
  const std::lock_guard lock(parsing);
  const auto read = [&]() -> api::Result<Lighting> {
    const auto bytes = read_below(input, "animation.json", std::int64_t{api::kAnimationBytesMax});
    if (!bytes) return bytes.error();
    const auto request = api::parse_job_request(*bytes);
    if (!request) return request.error();
    const auto document = api::parse_json(*bytes, "animation.json");
    if (!document) return document.error();
    const auto lighting = document->find("lighting");
    return Lighting{lighting == document->end() ? Json::object() : Json(*lighting), request->lighting.seed};
  };
  auto lighting = read();
  ::malloc_trim(0);
  return lighting;
}

api::Result<std::vector<HashedFile>> hashed_inputs(JobService& jobs, const Job& job) {
  const auto inputs = jobs.inputs(job);
  if (!inputs) return inputs.error();
  std::vector<HashedFile> files;
  for (const InputFile& input : *inputs) {
    if (!input.sha256.empty()) {
      files.push_back({input.name, input.bytes, input.sha256});
      continue;
    }
    const auto file = open_below(jobs.folder_of(job) / "input", input.name);
    if (!file) return api::Error{api::Fault::internal, file.error().message};
    const auto hash = sha256_of(*file);
    if (!hash) return hash.error();
    files.push_back({input.name, input.bytes, *hash});
  }
  return files;
}

Json list_of(const std::vector<HashedFile>& files) {
  Json list = Json::array();
  for (const HashedFile& file : files)
    list.push_back({{"path", file.path}, {"bytes", file.bytes}, {"sha256", file.sha256}});
  return list;
}

std::string json_of_reproduction(const Job& job, const Reproduction& reproduction, const Lighting& lighting) {
  const auto report = api::parse_job_report(job.report);
  Json json{
      {"keylume", KEYLUME_VERSION},
      {"job",
       {{"id", job.id}, {"name", job.settings.name}, {"frame_count", job.frame_count}, {"fps", job.fps}}},
      {"how", "keylume render FOLDER with this folder's input/, of this version, gives these artefacts"},
      {"seed", lighting.seed},
      {"lighting", lighting.as_given},
      {"fingerprint", report && !report->fingerprint.empty() ? Json(report->fingerprint) : Json(nullptr)},
      {"inputs", list_of(reproduction.inputs)},
      {"artefacts", list_of(reproduction.artefacts)}};
  return api::json_text(json) + "\n";
}

void add_sums(std::string& sums, std::string_view folder, const std::vector<HashedFile>& files) {
  for (const HashedFile& file : files)
    sums.append(file.sha256).append("  ").append(folder).append("/").append(file.path).append("\n");
}

api::Result<Reproduction> reproduction_of(JobService& jobs, const Job& job) {
  if (const api::Status here = must_have_results(job); !here) return here.error();
  const auto artefacts = jobs.artefacts(job);
  if (!artefacts) return artefacts.error();
  Reproduction reproduction;
  for (const ArtefactFile& file : *artefacts)
    reproduction.artefacts.push_back({file.path, file.bytes, file.sha256});
  auto inputs = hashed_inputs(jobs, job);
  if (!inputs) return inputs.error();
  reproduction.inputs = std::move(*inputs);
  const auto lighting = lighting_of(jobs.folder_of(job) / "input");
  if (!lighting) return api::Error{api::Fault::internal, lighting.error().message};
  reproduction.json = json_of_reproduction(job, reproduction, *lighting);
  reproduction.sums = sha256_of(reproduction.json) + "  reproduce.json\n";
  add_sums(reproduction.sums, "input", reproduction.inputs);
  add_sums(reproduction.sums, "artefacts", reproduction.artefacts);
  return reproduction;
}

std::size_t size_of(const Reproduction& reproduction) {
  constexpr std::size_t kPerFile = 256;
  return reproduction.json.size() + reproduction.sums.size() +
         kPerFile * (reproduction.inputs.size() + reproduction.artefacts.size());
}

}  // namespace

api::Result<std::shared_ptr<const Reproduction>> Reproductions::of(JobService& jobs, const Job& job) {
  const std::pair key{job.seq, job.settings.name};  // the rest of a job that has succeeded never changes
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
  }
  auto made = reproduction_of(jobs, job);
  if (!made) return made.error();
  const auto shared = std::make_shared<const Reproduction>(std::move(*made));
  const std::lock_guard lock(mutex_);
  while (!known_.empty() && (known_.size() >= kMax || bytes_ + size_of(*shared) > kBytesMax)) {
    bytes_ -= size_of(*known_.begin()->second);
    known_.erase(known_.begin());
  }
  if (size_of(*shared) <= kBytesMax && known_.emplace(key, shared).second) bytes_ += size_of(*shared);
  return shared;
}

}  // namespace server
