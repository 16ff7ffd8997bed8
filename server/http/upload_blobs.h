// Uploads whose files were sent before, one by one, and are named by their hashes.
#pragma once

#include <string_view>

#include "server/http/message.h"
#include "server/http/router.h"
#include "server/http/upload_receiver.h"

namespace server {

/// /v1/blobs/sha256/{hex}
void add_blob_routes(Router& router, JobService& jobs, const DataFolder& folder, const UploadLimits& limits);

bool is_json(const HttpRequest& request);

/// Reads a JSON body (api::JobFiles) and has `receiver` take the files that it names, as if they came as
/// parts. They must have been sent by the same owner. None: all are taken, or the receiver has refused one.
std::optional<HttpAnswer> receive_named_files(const HttpRequest& request, const ReadBody& read_body,
                                              JobService& jobs, UploadReceiver& receiver);

}  // namespace server
