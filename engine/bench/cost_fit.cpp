#include "engine/bench/cost_fit.h"

#include <cmath>

namespace engine {

double CostFit::largest_speed_up(double all_frames) const {
  return once_s > 0 ? seconds(all_frames) / once_s : 0;
}

CostFit fit_cost(std::span<const CostPoint> points) {
  const auto n = static_cast<double>(points.size());
  double mean_frames = 0, mean_seconds = 0;
  for (const CostPoint& point : points) {
    mean_frames += point.frames / n;
    mean_seconds += point.seconds / n;
  }
  double spread = 0, together = 0;
  for (const CostPoint& point : points) {
    spread += (point.frames - mean_frames) * (point.frames - mean_frames);
    together += (point.frames - mean_frames) * (point.seconds - mean_seconds);
  }
  if (!(spread > 0)) return {};
  CostFit fit;
  fit.per_frame_s = together / spread;
  fit.once_s = mean_seconds - fit.per_frame_s * mean_frames;
  double squares = 0;
  for (const CostPoint& point : points) {
    const double off = (point.seconds - fit.seconds(point.frames)) / point.seconds;
    squares += off * off / n;
  }
  fit.deviation = std::sqrt(squares);
  return fit;
}

}  // namespace engine
