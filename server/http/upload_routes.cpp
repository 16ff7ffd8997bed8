#include <memory>

#include "server/http/routes.h"
#include "server/http/upload_blobs.h"

namespace server {

void add_upload_routes(Router& router, JobService& jobs, const DataFolder& folder,
                       const UploadLimits& limits) {
  const auto blobs = std::make_shared<Blobs>(folder.blobs(), BlobLimits{});
  (void)blobs->collect();
  add_blob_routes(router, blobs, folder, limits);
  for (const std::string_view path : {kSubmitPath, kValidatePath, kPreviewPath})
    router.add_upload(
        "POST", std::string(path),
        [&jobs, &folder, blobs, limits](const HttpRequest& request, const PathValues&,
                                        const ReadBody& read_body) {
          return take_job(request, read_body, jobs, folder, *blobs, limits);
        },
        [&jobs, &folder, limits](const HttpRequest& request) {
          return refuse_upload_early(request, jobs, folder, limits);
        });
}

}  // namespace server
