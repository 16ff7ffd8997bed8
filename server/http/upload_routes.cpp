#include "server/http/routes.h"
#include "server/http/upload_blobs.h"

namespace server {

void add_upload_routes(Router& router, JobService& jobs, const DataFolder& folder,
                       const UploadLimits& limits) {
  add_blob_routes(router, jobs, folder, limits);
  for (const std::string_view path : {kSubmitPath, kValidatePath, kPreviewPath})
    router.add_upload(
        "POST", std::string(path),
        [&jobs, &folder, limits](const HttpRequest& request, const PathValues&, const ReadBody& read_body) {
          return take_job(request, read_body, jobs, folder, limits);
        },
        [&jobs, &folder, limits](const HttpRequest& request) {
          return refuse_upload_early(request, jobs, folder, limits);
        });
}

}  // namespace server
