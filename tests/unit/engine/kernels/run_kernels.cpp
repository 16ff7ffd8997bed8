// Runs the kernels on the same numbers whatever they are compiled for: `engine` is a macro here, the name of
// the namespace of one generation of registers (CMakeLists.txt), and the sources of the kernels are compiled
// with it.
#include "tests/unit/engine/kernels/run_kernels.h"

#include <array>

#include "engine/base/sobol.h"
#include "engine/direct/form_factor.h"
#include "engine/direct/shadow_samples.h"
#include "engine/lighting/row_kernels.h"
#include "engine/visibility/packet_kernel.h"
#include "engine/visibility/shaft.h"

namespace engine {
namespace {

/// Numbers in [low, high), the same for everybody.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  float in(float low, float high) {
    state_ = mix(state_ + 0x9e3779b97f4a7c15ull);
    return low + (high - low) * (static_cast<float>(state_ >> 40) * 0x1p-24f);
  }
  Vec3 point(float size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  std::vector<float> many(std::size_t count, float low, float high) {
    std::vector<float> values(count);
    for (float& value : values) value = in(low, high);
    return values;
  }

 private:
  std::uint64_t state_;
};

class Bytes {
 public:
  template <class T>
  void add(const T* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  KernelBytes take() { return std::move(bytes_); }

 private:
  KernelBytes bytes_;
};

PlacedFacet facet_at(Numbers& numbers) {
  PlacedFacet facet;
  facet.origin = numbers.point(4);
  facet.edge_u = numbers.point(2);
  facet.edge_v = numbers.point(2);
  facet.corners = {facet.origin, facet.origin + facet.edge_u, facet.origin + facet.edge_u + facet.edge_v,
                   facet.origin + facet.edge_v};
  facet.normal = normalized(cross(facet.edge_u, facet.edge_v));
  return facet;
}

KernelBytes sum_rows() {
  constexpr std::size_t kWidth = 3 * 37, kRows = 20;  // no multiple of any register
  Numbers numbers(1);
  const std::vector<float> rows = numbers.many(kWidth * kRows, -1, 1), other = numbers.many(kWidth, 0, 2);
  std::vector<Exchange> exchanges;
  for (std::uint32_t k = 0; k < 50; ++k) exchanges.emplace_back(k * 7 % kRows);
  std::vector<float> sum(kWidth), changed(kWidth), reflected(kWidth);
  add_rows(sum.data(), rows.data(), kWidth, exchanges);
  const auto pattern = [&](Rgb colour) { return RowPattern(colour, kWidth); };
  reflect_sum(sum.data(), other.data(), pattern({.3f, .5f, .7f}), pattern({1, .9f, .8f}),
              pattern({.1f, .2f, .3f}), pattern({.01f, .02f, .03f}), kWidth, reflected.data());
  add_deviations(other.data(), pattern({.2f, -.3f, .4f}), kWidth, reflected.data());
  const float largest = add_changes(sum.data(), reflected.data(), .37f, kWidth, changed.data());
  add_scaled(changed.data(), other.data(), .11f, kWidth);
  Bytes bytes;
  bytes.add(sum.data(), kWidth);
  bytes.add(reflected.data(), kWidth);
  bytes.add(changed.data(), kWidth);
  bytes.add(&largest, 1);
  return bytes.take();
}

KernelBytes trace_packets() {
  constexpr std::size_t kFacets = 40;
  Numbers numbers(2);
  std::vector<PlacedFacet> facets;
  std::vector<Box> boxes;
  for (std::size_t k = 0; k < kFacets; ++k) {
    facets.push_back(facet_at(numbers));
    boxes.push_back(box_of(facets.back().corners));
  }
  const BoxHierarchy hierarchy = build_hierarchy(boxes, 4);
  FacetTree tree{hierarchy.nodes, {}, {0, 0, 0}};
  for (const std::uint32_t k : hierarchy.order)
    tree.tests.push_back(facet_test(facets[k], k % 3 == 0, tree.centre));
  TraceLists lists;
  Bytes bytes;
  for (int packet_count = 0; packet_count < 50; ++packet_count) {
    LinePacket packet;
    const Vec3 along = numbers.point(1);
    for (std::uint32_t lane = 0; lane < 1 + static_cast<std::uint32_t>(packet_count) % kLanes; ++lane) {
      Ray ray;
      ray.direction = packet_count % 2 == 0 ? along : numbers.point(1);
      ray.origin = numbers.point(3) - 8.0f * ray.direction;
      packet.push(ray);
    }
    std::vector<PacketHit> hits;
    const std::uint32_t root = 0;
    trace_packet(tree, {&root, 1}, packet, lists, hits);
    bytes.add(hits.data(), hits.size());
  }
  return bytes.take();
}

KernelBytes sift_shafts() {
  Numbers numbers(3);
  Bytes bytes;
  for (int k = 0; k < 200; ++k) {
    std::array<ShaftEnd, 2> ends;
    for (ShaftEnd& end : ends) {
      const PlacedFacet facet = facet_at(numbers);
      end = {facet.corners, 4, facet.normal, 1e-4f};
    }
    const Shaft shaft(ends[0], ends[1]);
    FacetLanes lanes;
    for (std::size_t lane = 0; lane < FacetLanes::kCount; ++lane) {
      const PlacedFacet facet = facet_at(numbers);
      lanes.set(lane, facet.corners, facet.normal);
    }
    std::uint32_t entered = 0;
    const std::uint32_t met = shaft.may_meet(lanes, entered);
    const Vec3 corner = numbers.point(4);
    const std::uint32_t box = shaft.may_meet(Box{corner, corner + Vec3{1, 1, 1}}) ? 1 : 0;
    for (const std::uint32_t bits : {met, met & entered, box}) bytes.add(&bits, 1);
  }
  return bytes.take();
}

KernelBytes draw_samples() {
  Numbers numbers(4);
  SobolBits bits;
  SobolSeeds seeds;
  for (std::size_t lane = 0; lane < SobolBits::kCount; ++lane) {
    bits.set(lane, static_cast<std::uint32_t>(lane));
    seeds[lane] = stream_seed(5, lane / 4);
  }
  SobolPoints points;
  const SobolBits* const one = &bits;
  scramble(&one, &seeds, 1, &points);
  const PlacedFacet from = facet_at(numbers), to = facet_at(numbers);
  const Spread here{from.origin, from.edge_u, from.edge_v, false, {1, 2, .5f, 3}};
  const Spread there{to.origin, to.edge_u, to.edge_v, true};
  SpreadPoints starts, ends;
  spread(&here, &points, 0, 1, &starts);
  spread(&there, &points, 2, 1, &ends);
  RayLanes rays;
  SampleLanes weights;
  join({from.normal, to.normal, 1e-4f * from.normal, 1e-4f * to.normal}, &starts, &ends, 1, &rays, &weights);
  std::array<std::uint32_t, 20> moving;
  for (std::size_t slot = 0; slot < moving.size(); ++slot)
    moving[slot] = static_cast<std::uint32_t>(mix(slot));
  std::array<float, 20> sums{};
  sum_blocked(moving.data(), 0x11u, 0xfff7u, weights, 0, 16, sums.size(), sums.data());
  Bytes bytes;
  bytes.add(&points, 1);
  bytes.add(&starts, 1);
  bytes.add(&rays, 1);
  bytes.add(&weights, 1);
  bytes.add(&sums, 1);
  return bytes.take();
}

KernelBytes find_form_factors() {
  Numbers numbers(6);
  Bytes bytes;
  for (int k = 0; k < 50; ++k) {
    const PlacedFacet polygon = facet_at(numbers), receiver = facet_at(numbers);
    const std::vector<float> u = numbers.many(37, 0, 1), v = numbers.many(37, 0, 1);
    std::array<std::vector<float>, 3> points;
    for (std::size_t p = 0; p < u.size(); ++p) {
      const Vec3 at = point_at(receiver, u[p], v[p]);
      points[0].push_back(at.x), points[1].push_back(at.y), points[2].push_back(at.z);
    }
    const PolygonOverPlane over(receiver.origin, receiver.normal, polygon.corners, polygon.normal);
    std::vector<float> factors(u.size());
    over.form_factors({points[0].data(), points[1].data(), points[2].data(), u.size()}, factors.data());
    bytes.add(factors.data(), factors.size());
  }
  return bytes.take();
}

}  // namespace

std::vector<NamedBytes> run_kernels() {
  return {{"sums of rows", sum_rows()},
          {"packets of lines", trace_packets()},
          {"shafts", sift_shafts()},
          {"samples", draw_samples()},
          {"form factors", find_form_factors()}};
}

}  // namespace engine
