// Is there anything to do? What an earlier run has left in a job's folder.
#pragma once

#include <string>

#include "engine/worker/job_folder.h"

namespace engine {

enum class EarlierRun {
  none,      ///< or it did not succeed
  whole,     ///< of this very job, by this program, and every artefact is as it was written
  of_other,  ///< of other input files, or by another program
  damaged,   ///< an artefact is missing or changed
};

/// Compares report.json with `fingerprint` (job_fingerprint of the input folder) and the artefacts with
/// manifest.json: reads all of them.
EarlierRun look_for_earlier_run(const JobFolder& folder, const std::string& fingerprint);

}  // namespace engine
