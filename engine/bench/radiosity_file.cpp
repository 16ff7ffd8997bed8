#include "engine/bench/radiosity_file.h"

#include <bit>
#include <cstdio>
#include <string>

namespace engine {

static_assert(sizeof(Rgb) == 3 * sizeof(float) && std::endian::native == std::endian::little);

api::Result<RadiosityFile> RadiosityFile::open(const std::filesystem::path& path) {
  RadiosityFile opened;
  opened.path_ = path;
  opened.file_.open(path, std::ios::binary);
  if (!opened.file_) return api::Error{api::Fault::not_found, "cannot read " + path.string()};
  // Version 1.0: magic, two bytes of version, length of the text in two bytes, text.
  unsigned char begin[10] = {};
  opened.file_.read(reinterpret_cast<char*>(begin), sizeof begin);
  const std::uint64_t length = begin[8] + 256u * begin[9];
  std::string text(length, '\0');
  opened.file_.read(text.data(), static_cast<std::streamsize>(length));
  unsigned frames = 0, patches = 0;
  const std::size_t shape = text.find("'shape': (");
  const bool is_ours = opened.file_ && shape != std::string::npos &&
                       text.find("'<f4'") != std::string::npos &&
                       std::sscanf(text.c_str() + shape, "'shape': (%u, %u, 3, )", &frames, &patches) == 2;
  if (!is_ours)
    return api::Error{api::Fault::invalid_request, path.string() + " is not an array of radiosity"};
  opened.data_begin_ = sizeof begin + length;
  opened.frames_ = frames;
  opened.patches_ = patches;
  opened.values_.resize(patches);
  return opened;
}

api::Result<std::span<const Rgb>> RadiosityFile::read(std::uint32_t frame) {
  const std::uint64_t bytes = std::uint64_t{patches_} * sizeof(Rgb);
  file_.seekg(static_cast<std::streamoff>(data_begin_ + frame * bytes));
  file_.read(reinterpret_cast<char*>(values_.data()), static_cast<std::streamsize>(bytes));
  if (!file_)
    return api::Error{api::Fault::internal, path_.string() + " ends before frame " + std::to_string(frame)};
  return std::span<const Rgb>(values_);
}

}  // namespace engine
