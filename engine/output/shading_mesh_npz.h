// The geometry and the cameras of a job for those who draw its radiosity themselves: the walk in a browser.
#pragma once

#include <filesystem>
#include <vector>

#include "api/image_options.h"
#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/image/node_rows.h"
#include "engine/image/shading_mesh.h"
#include "engine/output/artefacts.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace engine {

/// What is written; all of it outlives the call.
struct WalkScene {
  const Scene& scene;
  const Patches& patches;
  const Animation& animation;
  const ShadingMesh& mesh;
  const NodeRows* rows;  ///< null: no radiosity belongs to it, and its rows are empty
  const std::vector<api::ImageOptions>& images;
  ShownAs shown_as;
  double fps = 24;
  double metres_per_unit = 1;  ///< of the job: for those who send a camera back in its units
  double half_scale = 1;       ///< W/m^2 per unit of a half float that radiosity is sent as
};

/// shading_mesh.npz (stored, little-endian) with, for N nodes, P patches, F frames, C cameras, L lights:
///   node_position (N,3) float32 [m] object space
///   row_first (N+1) uint32, row_patch (M) uint32, row_weight (M) float32: the radiosity of node n is the sum
///     of row_weight[k] x patch radiosity[row_patch[k]], k = row_first[n] .. row_first[n+1] - 1: that of the
///     job's pictures, but see NodeRows for textures
///   patch_nodes (P,4) uint32: see PatchNodes; a triangle's fourth is 0xffffffff. Inside, radiosity is
///     bilinear between four nodes, linear between three
///   patch_object, patch_material, patch_facet (P) uint32: into object_names, material_names, and a number
///     that the patches of one flat piece of a polygon share, on both of its sides
///   patch_reflectance (P,3) float32: in frame 0; of a texture its mean over the patch
///   object_names, material_names, poses (objects,F,3,4) float32, visible (objects,F) uint8: as patches.npz
///   material_emits (materials) uint8: 1 where it emits in some frame
///   camera_names, and as the pictures see: camera_position, camera_forward, camera_up (C,F,3) float32, the
///     latter two of unit length and at right angles, camera_vertical_fov_deg (C,F) float32;
///     image_size (C,2) uint32: width and height of the job's first pictures by it, 0 where it asks for none
///   light_names, light_kind (L) uint8: 0 point, 1 spot, 2 directional; light_position, light_direction
///     (L,F,3) float32; what a kind has not is 0
///   up (3) float64, fps (1), metres_per_unit (1), auto_exposure (1), half_scale (1) float64
/// Errors: out_of_resources beyond 4 GiB; disk_full; internal.
api::Status write_shading_mesh_npz(const std::filesystem::path& path, const WalkScene& walk);

/// The power of two next to a sequence's mean radiosity, by its auto_exposure_factor(): half floats of
/// radiosity / half_scale keep 11 bits from 6e-5 to 65504 times that mean.
double half_scale_of(double auto_exposure);

/// About as many bytes as write_shading_mesh_npz() would write without rows.
std::uint64_t walk_bytes(std::uint64_t patches, std::uint64_t objects, std::uint64_t cameras,
                         std::uint64_t lights, std::uint64_t frames);

}  // namespace engine
