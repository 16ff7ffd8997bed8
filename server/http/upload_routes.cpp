#include "server/http/routes.h"

namespace server {

void add_upload_routes(Router& router, JobService& jobs, const DataFolder& folder,
                       const UploadLimits& limits) {
  for (const std::string_view path : {kSubmitPath, kValidatePath})
    router.add_upload(
        "POST", std::string(path),
        [&jobs, &folder, limits](const HttpRequest& request, const PathValues&, const ReadBody& read_body) {
          return take_job(request, read_body, jobs, folder, limits);
        },
        [&folder, limits](const HttpRequest& request) {
          return refuse_upload_early(request, folder, limits);
        });
}

}  // namespace server
