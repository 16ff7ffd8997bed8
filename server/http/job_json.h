// Jobs and frames as clients see them: api/openapi.yaml, components/schemas.
#pragma once

#include <string>
#include <vector>

#include "server/jobs/job_service.h"

namespace server {

/// components/schemas/Job; `positions` have the job's place, if it is queued
std::string job_json(const Job& job, const QueuePositions& positions = {});
/// What changes with every change of job_json: the version, and the place where there is one.
std::string job_etag(const Job& job, const QueuePositions& positions);
/// components/schemas/Queue
std::string queue_json(const QueueReport& report);
/// components/schemas/Removal
std::string removal_json(const Job& job, const Removal& removal);
/// components/schemas/Validation. The report has a forecast.
std::string validation_json(const api::JobReport& report);
/// components/schemas/JobList; without the `errors` of failed jobs
std::string job_page_json(const JobPage& page, const QueuePositions& positions = {});

/// What became of one job of a batch.
struct BatchResult {
  std::string id;
  int status = 0;      ///< as the request for this job alone would have been answered
  std::string state;   ///< of the job now; empty: there is none any more
  std::string detail;  ///< why it was refused
};
/// components/schemas/BatchResults
std::string batch_json(const std::vector<BatchResult>& results);

/// Where the pictures of one frame lie, from the paths of the artefacts.
struct FrameImages {
  struct Camera {
    std::string name;
    bool png = false;
    bool jpg = false;
    bool exr = false;
  };
  std::vector<Camera> cameras;  ///< by name
};

/// One entry per frame, from paths such as images/front/0007.png.
std::vector<FrameImages> images_by_frame(const std::vector<ArtefactFile>& artefacts,
                                         std::uint32_t frame_count);

/// components/schemas/Frame
std::string frame_json(const Job& job, const api::FrameRecord& frame, const FrameImages& images);
/// components/schemas/FrameList
std::string frames_json(const Job& job, const std::vector<api::FrameRecord>& frames,
                        const std::vector<FrameImages>& images);

/// The path of an image among the artefacts: images/front/0007.png. `extension` without a dot.
std::string image_path(std::string_view camera, std::uint32_t frame, std::string_view extension);

}  // namespace server
