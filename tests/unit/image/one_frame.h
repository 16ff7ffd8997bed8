// One frame as a picture in memory.
#pragma once

#include <functional>
#include <vector>

#include "engine/image/image_rows.h"
#include "engine/image/render_frame.h"

namespace tests {

inline engine::Image one_frame(const engine::ShadedScene& stage, const engine::FrameView& view,
                               const std::vector<engine::Rgb>& node_values_w_m2, std::uint32_t samples,
                               const engine::StaticView* static_view = nullptr) {
  const std::vector<engine::NodeValues> frames{node_values_w_m2};
  const auto lanes = engine::gather_lanes(frames, [](std::size_t) { return 1e30f; });
  std::vector<engine::Image> images(1, engine::Image(view.camera.width, view.camera.height));
  const engine::ShadedRows rows{lanes, [&](std::uint32_t y, std::span<const float> radiance) {
                                  engine::store_row(radiance, y, images);
                                }};
  engine::render_frames(stage, {&view, 1}, static_view, {&rows, 1}, samples, [] { return false; });
  return images[0];
}

}  // namespace tests
