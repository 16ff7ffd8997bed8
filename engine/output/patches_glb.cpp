#include "engine/output/patches_glb.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string_view>

#include "engine/image/tone_curve.h"

namespace engine {
namespace {

/// Patches that are read at once.
constexpr std::uint64_t kBlock = 4096;
constexpr std::uint64_t kCornerFloats = 12;
constexpr std::uint64_t kObjectsMax = 1'000'000;

api::Error unfit(std::string_view what) {
  return {api::Fault::internal, "patches.npz or radiosity.npy: " + std::string(what)};
}

bool is_of(const ArrayPlace& place, std::string_view dtype, std::initializer_list<std::uint64_t> inner) {
  return place.dtype == dtype && place.shape.size() == inner.size() + 1 &&
         std::equal(inner.begin(), inner.end(), place.shape.begin() + 1);
}

std::string text_of(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::string text_of(const std::array<float, 3>& values) {
  std::string text(1, '[');
  for (const float value : values) text.append(text.size() > 1 ? "," : "").append(text_of(value));
  return text.append("]");
}

void put32(std::string& out, std::uint64_t value) {
  for (const int shift : {0, 8, 16, 24}) out += static_cast<char>(value >> shift & 0xff);
}

/// "GLB" header, the JSON chunk padded with spaces, and the header of the binary chunk.
std::string glb_head(std::string json, std::uint64_t binary_bytes) {
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string head = "glTF";
  put32(head, 2);
  put32(head, 12 + 8 + json.size() + 8 + binary_bytes);
  put32(head, json.size());
  head += "JSON" + json;
  put32(head, binary_bytes);
  return head + std::string("BIN\0", 4);
}

std::string buffer_view(std::uint64_t offset, std::uint64_t bytes, std::string_view target) {
  return R"({"buffer":0,"byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" +
         std::to_string(bytes) + R"(,"target":)" + std::string(target) + "}";
}

std::string accessor(int view, std::string_view type, std::string_view rest, std::uint64_t count) {
  return R"({"bufferView":)" + std::to_string(view) + R"(,"count":)" + std::to_string(count) +
         R"(,"type":")" + std::string(type) + R"(",)" + std::string(rest) + "}";
}

}  // namespace

api::Status PatchesGlb::read_poses(const ArrayPlace& poses, const ArrayPlace& visible,
                                   api::FrameIndex frame) {
  const std::uint64_t count = poses.shape[0], frames = poses.shape[1];
  if (count > kObjectsMax || visible.shape[0] != count || visible.shape[1] != frames)
    return unfit("poses and visible are of different shapes");
  poses_.resize(count);
  visible_objects_.resize(count);
  for (std::uint64_t o = 0; o < count; ++o) {
    const std::uint64_t at = o * frames + frame;
    auto read = read_at(patches_, poses.offset_bytes + at * sizeof poses_[o], &poses_[o], sizeof poses_[o]);
    if (read) read = read_at(patches_, visible.offset_bytes + at, &visible_objects_[o], 1);
    if (!read) return read;
    if (!z_up_) continue;
    // (x, y, z) -> (x, z, -y): a quarter turn about x.
    std::array<double, 12>& m = poses_[o];
    std::swap_ranges(m.begin() + 4, m.begin() + 8, m.begin() + 8);
    for (std::size_t k = 8; k < 12; ++k) m[k] = -m[k];
  }
  return api::Done{};
}

api::Status PatchesGlb::find_runs(const ArrayPlace& object) {
  std::vector<std::uint32_t> block;
  for (std::uint64_t first = 0; first < object.shape[0]; first += block.size()) {
    block.resize(std::min(kBlock, object.shape[0] - first));
    if (auto read = read_at(patches_, object.offset_bytes + 4 * first, block.data(), 4 * block.size()); !read)
      return read;
    for (std::uint64_t k = 0; k < block.size(); ++k) {
      if (block[k] >= visible_objects_.size()) return unfit("a patch is of no object");
      if (visible_objects_[block[k]] == 0) continue;
      const bool goes_on = !runs_.empty() && runs_.back().first_patch + runs_.back().count == first + k;
      if (!goes_on) runs_.push_back({visible_, first + k, 0});
      ++runs_.back().count;
      ++visible_;
    }
  }
  if (visible_ == 0) return api::Error{api::Fault::not_found, "nothing is to be seen in this frame"};
  if (visible_ * kPatchBytes > std::numeric_limits<std::uint32_t>::max() - (1u << 20))
    return api::Error{api::Fault::out_of_resources, "the file would have more than 4 GiB"};
  return api::Done{};
}

api::Status PatchesGlb::find_bounds() {
  least_.fill(std::numeric_limits<float>::max());
  most_.fill(std::numeric_limits<float>::lowest());
  std::vector<float> corners(kBlock * kCornerFloats);
  for (const Run& run : runs_)
    for (std::uint64_t done = 0; done < run.count; done += kBlock) {
      const std::uint64_t count = std::min(kBlock, run.count - done);
      if (!make_positions(run.first_patch + done, count, corners.data())) return unfit("cannot be read");
      for (std::uint64_t k = 0; k < count * kCornerFloats; ++k) {
        if (!std::isfinite(corners[k])) return unfit("a corner is not finite");
        least_[k % 3] = std::min(least_[k % 3], corners[k]);
        most_[k % 3] = std::max(most_[k % 3], corners[k]);
      }
    }
  return api::Done{};
}

api::Status PatchesGlb::read_layout(int patches_npz, api::FrameIndex frame) {
  const auto arrays = find_npz(patches_npz);
  if (!arrays) return arrays.error();
  for (const char* name : {"corners", "object", "poses", "visible"})
    if (!arrays->contains(name)) return unfit("an array is missing");
  corners_ = arrays->find("corners")->second;
  objects_ = arrays->find("object")->second;
  const ArrayPlace& poses = arrays->find("poses")->second;
  const ArrayPlace& visible = arrays->find("visible")->second;
  if (!is_of(corners_, "<f4", {4, 3}) || !is_of(objects_, "<u4", {}) || poses.shape.size() != 4 ||
      !is_of(poses, "<f8", {poses.shape[1], 3, 4}) || !is_of(visible, "|u1", {poses.shape[1]}) ||
      corners_.shape[0] != objects_.shape[0])
    return unfit("an array is of another kind");
  if (frame >= poses.shape[1]) return api::Error{api::Fault::not_found, "there is no such frame"};
  // Jobs of earlier versions say neither: Y is up, and the factor is 1.
  double upward[3] = {0, 1, 0};
  if (const auto up = arrays->find("up"); up != arrays->end() && up->second.bytes == sizeof upward)
    if (auto read = read_at(patches_npz, up->second.offset_bytes, upward, sizeof upward); !read) return read;
  z_up_ = upward[2] > upward[1];
  const auto exposure = arrays->find("auto_exposure");
  if (!options_.auto_exposure)
    factor_ = std::exp2(options_.exposure_stops);
  else if (exposure != arrays->end() && exposure->second.bytes == sizeof factor_)
    if (auto read = read_at(patches_npz, exposure->second.offset_bytes, &factor_, sizeof factor_); !read)
      return read;
  if (auto read = read_poses(poses, visible, frame); !read) return read;
  if (auto found = find_runs(objects_); !found) return found;
  return find_bounds();
}

api::Result<PatchesGlb> PatchesGlb::open(int patches_npz, int radiosity_npy, const GlbOptions& options) {
  PatchesGlb glb;
  glb.patches_ = patches_npz;
  glb.radiosity_ = radiosity_npy;
  glb.options_ = options;
  if (auto read = glb.read_layout(patches_npz, options.frame); !read) return read.error();
  const auto series = find_npy(radiosity_npy);
  if (!series) return series.error();
  const std::uint64_t patches = glb.corners_.shape[0];
  if (!is_of(*series, "<f4", {patches, 3}) || options.frame >= series->shape[0])
    return unfit("they do not belong together");
  glb.radiosity_offset_ = series->offset_bytes + options.frame * patches * 12;
  glb.head_ = glb_head(glb.json(), glb.visible_ * kPatchBytes);
  return glb;
}

std::string PatchesGlb::json() const {
  const std::uint64_t vertices = visible_ * kVertices;
  const std::string positions =
      R"("componentType":5126,"min":)" + text_of(least_) + R"(,"max":)" + text_of(most_);
  const std::string tone = options_.tone_map == api::ToneMap::clip ? "clip" : "filmic";
  return R"({"asset":{"version":"2.0","generator":"Keylume"},"extensionsUsed":["KHR_materials_unlit"],)"
         R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"name":"patches"}],)"
         R"("extras":{"frame":)" +
         std::to_string(options_.frame) + R"(,"exposure_factor":)" + text_of(static_cast<float>(factor_)) +
         R"(,"tone_map":")" + tone + R"(","radiosity_unit":"W/m2"},)" +
         R"("materials":[{"name":"radiosity","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1],)"
         R"("metallicFactor":0,"roughnessFactor":0.9},"extensions":{"KHR_materials_unlit":{}}}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1,"_RADIOSITY":2},)"
         R"("indices":3,"material":0}]}],"accessors":[)" +
         accessor(0, "VEC3", positions, vertices) + "," +
         accessor(1, "VEC4", R"("componentType":5123,"normalized":true)", vertices) + "," +
         accessor(2, "VEC3", R"("componentType":5126)", vertices) + "," +
         accessor(3, "SCALAR", R"("componentType":5125)", 6 * visible_) + R"(],"bufferViews":[)" +
         buffer_view(0, 12 * vertices, "34962") + "," + buffer_view(12 * vertices, 8 * vertices, "34962") +
         "," + buffer_view(20 * vertices, 12 * vertices, "34962") + "," +
         buffer_view(32 * vertices, 24 * visible_, "34963") + R"(],"buffers":[{"byteLength":)" +
         std::to_string(visible_ * kPatchBytes) + "}]}";
}

const PatchesGlb::Run& PatchesGlb::run_of(std::uint64_t visible) const {
  const auto after =
      std::upper_bound(runs_.begin(), runs_.end(), visible,
                       [](std::uint64_t at, const Run& run) { return at < run.first_visible; });
  return *std::prev(after);
}

bool PatchesGlb::make_positions(std::uint64_t patch, std::uint64_t count, float* out) const {
  std::vector<std::uint32_t> object(count);
  const std::uint64_t bytes = kCornerFloats * sizeof(float);
  if (!read_at(patches_, objects_.offset_bytes + 4 * patch, object.data(), 4 * count) ||
      !read_at(patches_, corners_.offset_bytes + bytes * patch, out, bytes * count))
    return false;
  for (std::uint64_t k = 0; k < count; ++k) {
    if (object[k] >= poses_.size()) return false;
    const std::array<double, 12>& m = poses_[object[k]];
    for (float* p = out + kCornerFloats * k; p != out + kCornerFloats * (k + 1); p += 3) {
      const double x = p[0], y = p[1], z = p[2];
      for (std::size_t row = 0; row < 3; ++row)
        p[row] =
            static_cast<float>(m[4 * row] * x + m[4 * row + 1] * y + m[4 * row + 2] * z + m[4 * row + 3]);
    }
  }
  return true;
}

bool PatchesGlb::make_colours(std::uint64_t patch, std::uint64_t count, std::uint16_t* out) const {
  std::vector<float> radiosity(3 * count);
  if (!read_at(radiosity_, radiosity_offset_ + 12 * patch, radiosity.data(), 12 * count)) return false;
  constexpr double kWhole = 65535;
  for (std::uint64_t k = 0; k < count; ++k) {
    std::array<std::uint16_t, 4> colour{0, 0, 0, 65535};
    for (std::size_t c = 0; c < 3; ++c) {
      const double exposed = factor_ * radiosity[3 * k + c] / std::numbers::pi;
      // Neither NaN nor what is below 0 reaches the curve.
      if (exposed > 0)
        colour[c] = static_cast<std::uint16_t>(std::lround(kWhole * tone_curve(options_.tone_map, exposed)));
    }
    for (std::uint64_t vertex = 0; vertex < kVertices; ++vertex)
      std::memcpy(out + 4 * (kVertices * k + vertex), colour.data(), sizeof colour);
  }
  return true;
}

bool PatchesGlb::make_radiosity(std::uint64_t patch, std::uint64_t count, float* out) const {
  std::vector<float> radiosity(3 * count);
  if (!read_at(radiosity_, radiosity_offset_ + 12 * patch, radiosity.data(), 12 * count)) return false;
  for (std::uint64_t vertex = 0; vertex < kVertices * count; ++vertex)
    std::copy_n(&radiosity[3 * (vertex / kVertices)], 3, out + 3 * vertex);
  return true;
}

bool PatchesGlb::make(Region region, std::uint64_t first, std::uint64_t count,
                      std::vector<char>& bytes) const {
  const Run& run = run_of(first);
  const std::uint64_t patch = run.first_patch + (first - run.first_visible);
  switch (region) {
    case Region::position:
      return make_positions(patch, count, reinterpret_cast<float*>(bytes.data()));
    case Region::colour:
      return make_colours(patch, count, reinterpret_cast<std::uint16_t*>(bytes.data()));
    case Region::radiosity:
      return make_radiosity(patch, count, reinterpret_cast<float*>(bytes.data()));
    case Region::index:
      break;
  }
  auto* index = reinterpret_cast<std::uint32_t*>(bytes.data());
  for (std::uint64_t k = first; k < first + count; ++k)
    for (const std::uint32_t corner : {0, 1, 2, 0, 2, 3})
      *index++ = static_cast<std::uint32_t>(kVertices * k + corner);
  return true;
}

std::int64_t PatchesGlb::read(std::uint64_t at, char* to, std::uint64_t size) const {
  if (at >= size_bytes() || size == 0) return 0;
  if (at < head_.size()) {
    const std::uint64_t count = std::min(size, head_.size() - at);
    std::memcpy(to, head_.data() + at, count);
    return static_cast<std::int64_t>(count);
  }
  at -= head_.size();
  constexpr std::array<std::uint64_t, 4> kBytes{12 * kVertices, 8 * kVertices, 12 * kVertices, 24};
  std::size_t region = 0;
  for (; at >= kBytes[region] * visible_; ++region) at -= kBytes[region] * visible_;
  const std::uint64_t each = kBytes[region], first = at / each, skipped = at % each;
  const Run& run = run_of(first);
  const std::uint64_t wanted = (skipped + size + each - 1) / each;
  const std::uint64_t count = std::min({wanted, kBlock, run.first_visible + run.count - first});
  std::vector<char> bytes(count * each);
  if (!make(static_cast<Region>(region), first, count, bytes)) return -1;
  const std::uint64_t copied = std::min(size, count * each - skipped);
  std::memcpy(to, bytes.data() + skipped, copied);
  return static_cast<std::int64_t>(copied);
}

}  // namespace engine
