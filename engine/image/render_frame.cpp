#include "engine/image/render_frame.h"

#include <algorithm>
#include <atomic>

#include "engine/base/parallel.h"

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

void add_hit(const ShadedScene& stage, const PinholeCamera& camera, const TexturedHit& hit,
             std::uint32_t sample_count, PixelStart start, PixelRow& row) {
  if (stage.textures && stage.textures->is_textured(hit.at.facet))
    add_textured(stage, camera, hit, sample_count, start, row);
  else
    add_sample(stage, hit.at, 1.0f / static_cast<float>(sample_count), start, row);
}

void end_pixel(PixelRow& row) {
  row.plain_end.push_back(static_cast<std::uint32_t>(row.plain.size()));
  row.tinted_end.push_back(static_cast<std::uint32_t>(row.tinted.size()));
}

Ray sample_ray(const PinholeCamera& camera, std::uint32_t x, std::uint32_t y, SubPixel sample) {
  return camera.ray_through(static_cast<float>(x) + sample.x, static_cast<float>(y) + sample.y);
}

/// Appends what the static facets show in pixel (x, y), and how far they are.
void trace_static_pixel(const ShadedScene& stage, const PinholeCamera& camera,
                        std::span<const SubPixel> samples, std::uint32_t x, std::uint32_t y, PixelRow& row,
                        std::vector<float>& distances) {
  const PixelStart start{row.plain.size(), row.tinted.size()};
  for (const SubPixel sample : samples) {
    TexturedHit hit{{}, sample_ray(camera, x, y, sample), 0};
    if (stage.static_rays.nearest(hit.ray, hit.at)) {
      hit.ray.far = hit.at.distance;
      add_hit(stage, camera, hit, static_cast<std::uint32_t>(samples.size()), start, row);
    }
    distances.push_back(hit.ray.far);
  }
  end_pixel(row);
}

/// What one of the frames shows in a pixel. Owned by a row, so that pixels share its memory.
struct FramePixel {
  std::vector<TexturedHit> hits;  ///< [sample]
  std::vector<char> is_found;     ///< [sample]
  PixelRow blend;                 ///< of this pixel alone
};

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

void set_blend(const ShadedScene& stage, const PinholeCamera& camera, FramePixel& pixel) {
  clear(pixel.blend);
  for (std::size_t s = 0; s < pixel.hits.size(); ++s)
    if (pixel.is_found[s])
      add_hit(stage, camera, pixel.hits[s], static_cast<std::uint32_t>(pixel.hits.size()), {}, pixel.blend);
  end_pixel(pixel.blend);
}

/// Traces pixel (x, y) where `may_move` tells whether moving facets can be there.
void trace_pixel(const ShadedScene& stage, const FrameView& view, std::span<const SubPixel> samples,
                 std::uint32_t x, std::uint32_t y, bool may_move, FramePixel& pixel) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    TexturedHit& hit = pixel.hits[s];
    hit = {{}, sample_ray(view.camera, x, y, samples[s]), view.frame};
    bool found = stage.static_rays.nearest(hit.ray, hit.at);
    if (found) hit.ray.far = hit.at.distance;
    if (may_move) found = view.moving_rays.nearest(hit.ray, view.slot, hit.at) || found;
    pixel.is_found[s] = found;
  }
  set_blend(stage, view.camera, pixel);
}

/// The same with the distances of static facets known. False where no sample meets anything that moves.
bool trace_over_static(const ShadedScene& stage, const FrameView& view, std::span<const SubPixel> samples,
                       std::uint32_t x, std::uint32_t y, const float* static_distances, FramePixel& pixel) {
  bool moves = false;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    TexturedHit& hit = pixel.hits[s];
    hit = {{}, sample_ray(view.camera, x, y, samples[s]), view.frame};
    hit.ray.far = static_distances[s];
    pixel.is_found[s] = view.moving_rays.nearest(hit.ray, view.slot, hit.at);
    moves = moves || pixel.is_found[s];
  }
  if (!moves) return false;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (pixel.is_found[s]) continue;
    TexturedHit& hit = pixel.hits[s];
    hit.ray = sample_ray(view.camera, x, y, samples[s]);
    pixel.is_found[s] = stage.static_rays.nearest(hit.ray, hit.at);
    if (pixel.is_found[s]) hit.ray.far = hit.at.distance;
  }
  set_blend(stage, view.camera, pixel);
  return true;
}

/// Radiance of a row, of each ShadedRows.
using RowRadiance = std::vector<std::vector<float>>;

/// Row by row what the frames of a block show.
class RowRenderer {
 public:
  RowRenderer(const ShadedScene& stage, std::span<const FrameView> views, const StaticView* static_view,
              std::span<const ShadedRows> shaded, std::uint32_t samples_per_pixel)
      : stage_(stage),
        views_(views),
        static_view_(static_view),
        shaded_(shaded),
        samples_(sub_pixels(samples_per_pixel)) {}

  void render(std::uint32_t y) const {
    const std::uint32_t width = views_[0].camera.width;
    thread_local RowRadiance radiance;  // page faults cost more than the sums that fill it
    radiance.resize(shaded_.size());
    for (std::size_t i = 0; i < shaded_.size(); ++i) {
      radiance[i].resize(std::size_t{3} * shaded_[i].values.lanes * width);
      if (static_view_) shade_row(static_view_->rows[y], shaded_[i].values, radiance[i]);
    }
    FramePixel pixel{std::vector<TexturedHit>(samples_.size()), std::vector<char>(samples_.size()), {}};
    for (std::uint32_t lane = 0; lane < views_.size(); ++lane) {
      if (static_view_)
        render_motion(y, lane, pixel, radiance);
      else
        render_all(y, lane, pixel, radiance);
    }
    for (std::size_t i = 0; i < shaded_.size(); ++i) shaded_[i].take_row(y, radiance[i]);
  }

 private:
  /// What moves, over the static view.
  void render_motion(std::uint32_t y, std::uint32_t lane, FramePixel& pixel, RowRadiance& radiance) const {
    const FrameView& view = views_[lane];
    const float* const distances = static_view_->distances[y].data();
    for (const PixelSpan span : view.motion[y])
      for (std::uint32_t x = span.x0; x < span.x1; ++x)
        if (trace_over_static(stage_, view, samples_, x, y, distances + x * samples_.size(), pixel))
          set_pixel(pixel, x, lane, radiance);
  }

  void render_all(std::uint32_t y, std::uint32_t lane, FramePixel& pixel, RowRadiance& radiance) const {
    const FrameView& view = views_[lane];
    const auto render_span = [&](PixelSpan span, bool may_move) {
      for (std::uint32_t x = span.x0; x < span.x1; ++x) {
        trace_pixel(stage_, view, samples_, x, y, may_move, pixel);
        set_pixel(pixel, x, lane, radiance);
      }
    };
    std::uint32_t done = 0;
    for (const PixelSpan span : view.motion[y]) {
      render_span({done, span.x0}, false);
      render_span(span, true);
      done = span.x1;
    }
    render_span({done, view.camera.width}, false);
  }

  void set_pixel(const FramePixel& pixel, std::uint32_t x, std::uint32_t lane, RowRadiance& radiance) const {
    for (std::size_t i = 0; i < shaded_.size(); ++i) {
      const LaneValues& values = shaded_[i].values;
      shade_pixel(pixel.blend, values, lane, radiance[i].data() + std::size_t{3} * values.lanes * x);
    }
  }

  const ShadedScene& stage_;
  std::span<const FrameView> views_;
  const StaticView* static_view_;
  std::span<const ShadedRows> shaded_;
  std::vector<SubPixel> samples_;
};

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

}  // namespace

std::unique_ptr<StaticView> see_static(const ShadedScene& stage, const PinholeCamera& camera,
                                       std::uint32_t samples_per_pixel, std::size_t bytes_max,
                                       const std::function<bool()>& stop_requested) {
  auto view = std::make_unique<StaticView>();
  view->rows.resize(camera.height);
  view->distances.resize(camera.height);
  const auto samples = sub_pixels(samples_per_pixel);
  std::atomic<std::size_t> bytes = 0;
  const auto too_large_or_stopped = [&] { return bytes > bytes_max || stop_requested(); };
  const bool whole = for_each_row(camera.height, too_large_or_stopped, [&](std::uint32_t y) {
    PixelRow& row = view->rows[y];
    for (std::uint32_t x = 0; x < camera.width; ++x)
      trace_static_pixel(stage, camera, samples, x, y, row, view->distances[y]);
    row.plain.shrink_to_fit();
    row.tinted.shrink_to_fit();
    bytes += bytes_of(row) + view->distances[y].size() * sizeof(float);
  });
  return whole && bytes <= bytes_max ? std::move(view) : nullptr;
}

bool render_frames(const ShadedScene& stage, std::span<const FrameView> views, const StaticView* static_view,
                   std::span<const ShadedRows> shaded, std::uint32_t samples_per_pixel,
                   const std::function<bool()>& stop_requested) {
  const RowRenderer renderer(stage, views, static_view, shaded, samples_per_pixel);
  return for_each_row(views[0].camera.height, stop_requested, [&](std::uint32_t y) { renderer.render(y); });
}

}  // namespace engine
