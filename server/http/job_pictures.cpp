#include "server/http/job_pictures.h"

#include <malloc.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <utility>

#include "api/job_request.h"

namespace server {
namespace {

constexpr std::size_t kRememberedMax = 8;

api::Result<std::shared_ptr<const JobPictures>> read_pictures(const std::filesystem::path& input) {
  const auto bytes = read_below(input, "animation.json", std::int64_t{api::kAnimationBytesMax});
  if (!bytes) return api::Error{api::Fault::internal, bytes.error().message};
  auto request = api::parse_job_request(*bytes);
  if (!request) return api::Error{api::Fault::internal, request.error().message};
  auto pictures = std::make_shared<JobPictures>();
  pictures->viewed = api::viewed_job(*request);
  pictures->images = std::move(request->images);
  return std::shared_ptr<const JobPictures>(std::move(pictures));
}

}  // namespace

const api::ImageOptions* JobPictures::of(std::string_view camera) const {
  const auto found = std::find_if(images.begin(), images.end(),
                                  [&](const api::ImageOptions& image) { return image.camera == camera; });
  return found == images.end() ? nullptr : &*found;
}

api::Result<std::shared_ptr<const JobPictures>> pictures_of(JobService& jobs, const Job& job) {
  using Remembered = std::pair<std::string, std::shared_ptr<const JobPictures>>;
  static std::mutex mutex;
  static std::deque<Remembered> remembered;
  // A small file can become a large document: one at a time, and its memory is given back.
  const std::lock_guard lock(mutex);
  for (const Remembered& known : remembered)
    if (known.first == job.id) return known.second;
  auto pictures = read_pictures(jobs.folder_of(job) / "input");
  ::malloc_trim(0);
  if (!pictures) return pictures;
  if (remembered.size() == kRememberedMax) remembered.pop_front();
  remembered.emplace_back(job.id, *pictures);
  return pictures;
}

}  // namespace server
