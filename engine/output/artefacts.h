// The files a job leaves behind, other than images, and the manifest that lists them all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace engine {

/// Writes `bytes` to `path`: temporary name in the same folder, fsync, rename, fsync of the folder.
/// Errors: disk_full (ENOSPC, EDQUOT), internal with path and errno text otherwise.
api::Status write_file(const std::filesystem::path& path, std::string_view bytes);

/// radiosity.npy: (frames, patches, 3) float32 little-endian, C order  [W/m^2]. Streamed, not held twice.
api::Status write_radiosity_npy(const std::filesystem::path& path, const PatchSeries& radiosity_w_m2);

/// How the job's pictures show what is written, for readers that make their own.
struct ShownAs {
  Vec3 up{0, 1, 0};          ///< the job's up axis
  double auto_exposure = 1;  ///< factor on radiance where no exposure is given: auto_exposure_factor()
};

/// patches.npz (stored, readable with numpy.load) with, for P patches:
///   corners (P,4,3) float32 [m] object space, counter-clockwise seen from the patch's own side; a triangle
///   repeats its last corner; normal (P,3) float32; area_m2 (P) float32; object (P) uint32; material (P)
///   uint32; poses (objects, frames, 3, 4) float64 object -> world; visible (objects, frames) uint8;
///   object_names, material_names: fixed-width unicode, cut after 256 characters; up (3) float64;
///   auto_exposure (1) float64, see ShownAs.
/// A pose in a frame that does not see the object is the identity. Error out_of_resources beyond 4 GiB.
api::Status write_patches_npz(const std::filesystem::path& path, const Scene& scene, const Patches& patches,
                              const Animation& animation, const ShownAs& shown_as);

struct Artefact {
  std::string path;  ///< relative to the artefacts folder, '/' between parts
  std::string
      media_type;  ///< "image/png", "image/x-exr", "application/x-npy", "application/zip", "application/json"
};

/// manifest.json in `folder`: {"artefacts":[{"path","media_type","bytes","sha256"}, ...]} in the order given,
/// sha256 in lower-case hexadecimal. Written last: its presence means that everything in it is whole.
api::Status write_manifest(const std::filesystem::path& folder, std::span<const Artefact> artefacts);

}  // namespace engine
