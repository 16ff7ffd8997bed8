#include "engine/image/render_frame.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numbers>
#include <optional>

#include "engine/base/parallel.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// Rows per parallel chunk, so that a stop is noticed in time.
constexpr std::uint32_t kBandRows = 8;

/// Adds to a pixel's blend, which starts at `first`. Samples of one pixel mostly share nodes.
template <class Weighted>
void add_weight(const Weighted& added, std::size_t first, std::vector<Weighted>& pixel) {
  const auto known = std::find_if(pixel.begin() + static_cast<std::ptrdiff_t>(first), pixel.end(),
                                  [&](const Weighted& other) { return other.node == added.node; });
  if (known == pixel.end())
    pixel.push_back(added);
  else
    known->weight = known->weight + added.weight;
}

/// Where the last pixel of a row that is being filled begins.
struct PixelStart {
  std::size_t plain = 0, tinted = 0;
};

/// A sample on a facet with a texture: E + rho H, see TexturedView.
void add_textured(const ShadedScene& stage, const PinholeCamera& camera, const TexturedHit& hit,
                  std::uint32_t sample_count, PixelStart start, PixelRow& row) {
  const float share = 1.0f / static_cast<float>(sample_count);
  const NodeBlend blend = blend_at(stage.mesh, stage.patches, hit.at.facet, hit.at.u, hit.at.v, hit.at.front);
  if (blend.count == 0) return;
  const Rgb rho = reflectance_in_sample(*stage.textures, hit, camera, sample_count);
  for (std::uint32_t c = 0; c < blend.count; ++c)
    add_weight<TintedWeight>({blend.nodes[c].node, (blend.nodes[c].weight * share) * rho}, start.tinted,
                             row.tinted);
  if (hit.at.front)
    add_weight<NodeWeight>({stage.textures->exitance_value(hit.at.facet), share}, start.plain, row.plain);
}

void add_sample(const ShadedScene& stage, const SurfaceHit& hit, float share, PixelStart start,
                PixelRow& row) {
  const NodeBlend blend = blend_at(stage.mesh, stage.patches, hit.facet, hit.u, hit.v, hit.front);
  for (std::uint32_t c = 0; c < blend.count; ++c)
    add_weight<NodeWeight>({blend.nodes[c].node, blend.nodes[c].weight * share}, start.plain, row.plain);
}

/// What rays meet besides the static facets; none: nothing.
struct MovingPart {
  const MovingRays* rays = nullptr;
  std::uint32_t slot = 0;
  FrameIndex frame = 0;
};

/// Appends the blend of pixel (x, y) to a row.
void trace_pixel(const ShadedScene& stage, const PinholeCamera& camera, const MovingPart& moving,
                 std::span<const SubPixel> samples, std::uint32_t x, std::uint32_t y, PixelRow& row) {
  const PixelStart start{row.plain.size(), row.tinted.size()};
  const auto sample_count = static_cast<std::uint32_t>(samples.size());
  const float share = 1.0f / static_cast<float>(sample_count);
  for (const SubPixel sample : samples) {
    Ray ray = camera.ray_through(static_cast<float>(x) + sample.x, static_cast<float>(y) + sample.y);
    SurfaceHit hit;
    bool found = stage.static_rays.nearest(ray, hit);
    if (found) ray.far = hit.distance;
    if (moving.rays) found = moving.rays->nearest(ray, moving.slot, hit) || found;
    if (found && stage.textures && stage.textures->is_textured(hit.facet))
      add_textured(stage, camera, {hit, ray, moving.frame}, sample_count, start, row);
    else if (found)
      add_sample(stage, hit, share, start, row);
  }
  row.plain_end.push_back(static_cast<std::uint32_t>(row.plain.size()));
  row.tinted_end.push_back(static_cast<std::uint32_t>(row.tinted.size()));
}

template <class Weighted>
std::span<const Weighted> part_at(const std::vector<Weighted>& parts, const std::vector<std::uint32_t>& end,
                                  std::uint32_t k) {
  const std::uint32_t first = k == 0 ? 0 : end[k - 1];
  return std::span(parts).subspan(first, end[k] - first);
}

/// Sets pixel (x, y) from the blend at position `k` of a row.
void set_pixel(const PixelRow& row, std::uint32_t k, std::span<const NodeValues> node_values, std::uint32_t x,
               std::uint32_t y, std::vector<Image>& images) {
  const auto plain = part_at(row.plain, row.plain_end, k);
  const auto tinted = part_at(row.tinted, row.tinted_end, k);
  for (std::size_t i = 0; i < images.size(); ++i) {
    Rgb radiosity;
    for (const NodeWeight& part : plain) radiosity += part.weight * node_values[i][part.node];
    for (const TintedWeight& part : tinted) radiosity += part.weight * node_values[i][part.node];
    images[i].at(x, y) = radiosity * std::numbers::inv_pi_v<float>;
  }
}

void clear(PixelRow& row) {
  row.plain.clear();
  row.tinted.clear();
  row.plain_end.clear();
  row.tinted_end.clear();
}

std::size_t bytes_of(const PixelRow& row) {
  return row.plain.size() * sizeof(NodeWeight) + row.tinted.size() * sizeof(TintedWeight) +
         (row.plain_end.size() + row.tinted_end.size()) * sizeof(std::uint32_t);
}

/// Does a sample of this pixel meet something that moves, be it hidden or not?
bool meets_motion(const FrameView& view, std::span<const SubPixel> samples, std::uint32_t x,
                  std::uint32_t y) {
  return std::any_of(samples.begin(), samples.end(), [&](SubPixel sample) {
    SurfaceHit hit;
    return view.moving_rays.nearest(
        view.camera.ray_through(static_cast<float>(x) + sample.x, static_cast<float>(y) + sample.y),
        view.slot, hit);
  });
}

void render_row(const ShadedScene& stage, const FrameView& view, std::span<const NodeValues> node_values,
                std::span<const SubPixel> samples, std::uint32_t y, std::vector<Image>& images) {
  PixelRow pixel;
  for (std::uint32_t x = 0; x < view.camera.width; ++x) {
    const bool may_move =
        !view.motion || std::any_of(view.motion->begin(), view.motion->end(),
                                    [&](const PixelRect& rect) { return rect.contains(x, y); });
    if (view.static_view && !(may_move && meets_motion(view, samples, x, y))) {
      set_pixel(view.static_view->rows[y], x, node_values, x, y, images);
      continue;
    }
    clear(pixel);
    const MovingPart moving{may_move ? &view.moving_rays : nullptr, view.slot, view.frame};
    trace_pixel(stage, view.camera, moving, samples, x, y, pixel);
    set_pixel(pixel, 0, node_values, x, y, images);
  }
}

/// Calls work(y) for every row, in parallel, until stopped. False when stopped.
bool for_each_row(std::uint32_t height, const std::function<bool()>& stop_requested,
                  const std::function<void(std::uint32_t)>& work) {
  std::atomic<bool> stopped = false;
  parallel_for((height + kBandRows - 1) / kBandRows, [&](std::size_t band) {
    const auto first = static_cast<std::uint32_t>(band * kBandRows);
    for (std::uint32_t y = first; y < std::min(first + kBandRows, height); ++y) {
      if (stopped || stop_requested()) {
        stopped = true;
        return;
      }
      work(y);
    }
  });
  return !stopped;
}

/// The corners of the box around an object's facets, in object space.
std::array<Vec3, 8> box_corners(Vec3 low, Vec3 high) {
  std::array<Vec3, 8> corners;
  for (unsigned c = 0; c < 8; ++c)
    corners[c] = {c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z};
  return corners;
}

}  // namespace

std::unique_ptr<StaticView> see_static(const ShadedScene& stage, const PinholeCamera& camera,
                                       std::uint32_t samples_per_pixel, std::size_t bytes_max,
                                       const std::function<bool()>& stop_requested) {
  auto view = std::make_unique<StaticView>();
  view->rows.resize(camera.height);
  const auto samples = sub_pixels(samples_per_pixel);
  std::atomic<std::size_t> bytes = 0;
  const auto too_large_or_stopped = [&] { return bytes > bytes_max || stop_requested(); };
  const bool whole = for_each_row(camera.height, too_large_or_stopped, [&](std::uint32_t y) {
    PixelRow& row = view->rows[y];
    for (std::uint32_t x = 0; x < camera.width; ++x) trace_pixel(stage, camera, {}, samples, x, y, row);
    row.plain.shrink_to_fit();
    row.tinted.shrink_to_fit();
    bytes += bytes_of(row);
  });
  return whole && bytes <= bytes_max ? std::move(view) : nullptr;
}

api::Result<std::vector<Image>> render_frame(const ShadedScene& stage, const FrameView& view,
                                             std::span<const NodeValues> node_values_w_m2,
                                             std::uint32_t samples_per_pixel,
                                             const std::function<bool()>& stop_requested) {
  std::vector<Image> images(node_values_w_m2.size(), Image(view.camera.width, view.camera.height));
  const auto samples = sub_pixels(samples_per_pixel);
  const bool whole = for_each_row(view.camera.height, stop_requested, [&](std::uint32_t y) {
    render_row(stage, view, node_values_w_m2, samples, y, images);
  });
  if (!whole) return api::Error{api::Fault::stopped, "stopped while rendering images"};
  return images;
}

std::vector<PixelRect> pixels_with_motion(const Patches& patches, const Animation& animation,
                                          FrameIndex frame, const PinholeCamera& camera) {
  struct Box {
    const Pose* pose = nullptr;  ///< none: rests, or is not there
    Vec3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  };
  std::vector<Box> boxes(animation.objects.size());
  for (std::size_t o = 0; o < boxes.size(); ++o)
    if (!animation.objects[o].is_static(animation.frame_count))
      for (const PlacedRange& range : placed_ranges(animation.objects[o], std::span(&frame, 1)))
        boxes[o].pose = range.pose;
  for (const Facet& facet : patches.facets) {
    Box& box = boxes[facet.object];
    if (!box.pose) continue;
    const Vec3 u_end = facet.origin + facet.edge_u, v_end = facet.origin + facet.edge_v;
    for (const Vec3 p : {facet.origin, u_end, v_end, u_end + facet.edge_v}) {
      box.low = min(box.low, p);
      box.high = max(box.high, p);
    }
  }
  std::vector<PixelRect> rects;
  for (const Box& box : boxes) {
    if (box.low.x > box.high.x) continue;
    auto corners = box_corners(box.low, box.high);
    for (Vec3& corner : corners) corner = transform_point(*box.pose, corner);
    const PixelRect rect = pixels_around(camera, corners);
    if (rect.x0 < rect.x1) rects.push_back(rect);
  }
  return rects;
}

}  // namespace engine
