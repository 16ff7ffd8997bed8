#include <array>
#include <fstream>

#include "engine/bench/bench_files.h"
#include "engine/bench/radiosity_file.h"
#include "engine/bench/sequence_error.h"
#include "engine/output/npy.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

api::Error unlike(const fs::path& one, const fs::path& other) {
  return {api::Fault::invalid_request, one.string() + " does not belong to " + other.string()};
}

std::vector<FramePair> one_by_one(std::uint32_t count) {
  std::vector<FramePair> pairs;
  for (std::uint32_t frame = 0; frame < count; ++frame) pairs.push_back({frame, frame});
  return pairs;
}

}  // namespace

api::Result<std::vector<ErrorSums>> compare_sequences(std::span<const PatchWeights> sets,
                                                      const fs::path& values, const fs::path& reference,
                                                      std::span<const FramePair> frames) {
  auto ours = RadiosityFile::open(values);
  if (!ours) return ours.error();
  auto theirs = RadiosityFile::open(reference);
  if (!theirs) return theirs.error();
  if (ours->patch_count() != theirs->patch_count()) return unlike(values, reference);
  const auto every = one_by_one(frames.empty() ? ours->frame_count() : 0);
  std::vector<ErrorSums> sums(sets.size());
  for (const FramePair& pair : frames.empty() ? std::span<const FramePair>(every) : frames) {
    if (pair.values >= ours->frame_count() || pair.reference >= theirs->frame_count())
      return unlike(values, reference);
    const auto a = ours->read(pair.values);
    if (!a) return a.error();
    const auto b = theirs->read(pair.reference);
    if (!b) return b.error();
    for (std::size_t k = 0; k < sets.size(); ++k) {
      if (sets[k].size() != a->size()) return unlike(values, reference);
      sums[k] += compare(sets[k], *a, *b);
    }
  }
  return sums;
}

api::Status write_mean(const fs::path& one, const fs::path& other, const fs::path& mean) {
  auto first = RadiosityFile::open(one);
  if (!first) return first.error();
  auto second = RadiosityFile::open(other);
  if (!second) return second.error();
  const std::uint32_t frames = first->frame_count(), patches = first->patch_count();
  if (second->frame_count() != frames || second->patch_count() != patches) return unlike(one, other);
  std::ofstream file(mean, std::ios::binary | std::ios::trunc);
  const std::array<std::uint64_t, 3> shape{frames, patches, 3};
  const std::string header = npy_header("<f4", shape);
  file.write(header.data(), static_cast<std::streamsize>(header.size()));
  std::vector<Rgb> between(patches);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const auto a = first->read(frame);
    if (!a) return a.error();
    const auto b = second->read(frame);
    if (!b) return b.error();
    for (std::uint32_t i = 0; i < patches; ++i) between[i] = 0.5f * ((*a)[i] + (*b)[i]);
    file.write(reinterpret_cast<const char*>(between.data()),
               static_cast<std::streamsize>(between.size() * sizeof(Rgb)));
  }
  file.close();
  return file ? api::Status(api::Done{}) : api::Error{api::Fault::internal, "cannot write " + mean.string()};
}

}  // namespace engine
