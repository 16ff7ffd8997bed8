// The statements of an OBJ file, one by one. Internal to engine/scene.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/scene/file_violations.h"
#include "engine/scene/obj_file.h"
#include "engine/scene/statement_reader.h"

namespace engine {

/// What an index of a face corner counts: v, vt, vn.
enum IndexKind { position, texture, normal, kind_count };
using Counts = std::array<std::uint64_t, kind_count>;

/// Transparent hash, so that words of the file are looked up without a copy.
struct NameHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>{}(name); }
};
using NameIndex = std::unordered_map<std::string, std::uint32_t, NameHash, std::equal_to<>>;

/// OBJ allows a face to name vertices that follow later in the file. Few files do, so a first reading takes
/// any index above the count so far on trust; where the trust was misplaced (`highest` above the final
/// counts) the file is read again with the counts known.
class ObjReader {
 public:
  ObjReader(std::span<const std::string> animated, double metres_per_unit, const SceneLimits& limits,
            FileViolations& violations, const std::function<bool()>& stop_requested,
            const std::optional<Counts>& final_counts)
      : metres_per_unit_(metres_per_unit),
        limits_(limits),
        violations_(violations),
        stop_requested_(stop_requested),
        final_counts_(final_counts) {
    for (std::uint32_t i = 1; i < animated.size(); ++i) animated_.emplace(animated[i], i);
    obj_.animated_seen.assign(animated.size(), false);
  }

  api::Result<ObjFile> read(const std::filesystem::path& file);
  const Counts& counts() const { return counts_; }
  bool trust_misplaced() const {
    for (int kind = 0; kind < kind_count; ++kind)
      if (highest_[kind] > counts_[kind]) return true;
    return false;
  }

 private:
  api::Status take(const Statement& statement);
  void take_vertex(Tokens& words, const Token& keyword);
  std::array<double, 8> take_vector(Tokens& words, const Token& keyword, std::size_t fewest,
                                    std::size_t most);
  void take_uv(Tokens& words, const Token& keyword);
  void take_normal(Tokens& words, const Token& keyword);
  void take_face(Tokens& words, const Token& keyword);
  bool take_corner(const Token& word);
  void add_corner(const std::array<std::int64_t, kind_count>& index);
  void drop_corners(std::size_t first);
  bool take_index(const Token& word, const char*& at, IndexKind kind, std::int64_t& index);
  bool take_rare_index(const Token& word, const char*& at, IndexKind kind, std::int64_t& index);
  void finish_polygon(std::size_t first, const Token& keyword);
  void take_object(Tokens& words);
  void take_groups(Tokens& words);
  api::Status take_material(Tokens& words, const Token& keyword);
  void take_libraries(Tokens& words, const Token& keyword);
  std::uint32_t see_unit(const std::string& name);
  std::uint32_t material_of_face();
  std::size_t read_numbers(Tokens& words, std::array<double, 8>& values, bool& good);
  api::Error beyond_limit(std::uint32_t line, const char* what, std::size_t limit) const;

  const double metres_per_unit_;
  const SceneLimits& limits_;
  FileViolations& violations_;
  const std::function<bool()>& stop_requested_;
  const std::optional<Counts> final_counts_;
  ObjFile obj_;
  Counts counts_{};
  Counts highest_{};

  NameIndex animated_;
  std::unordered_set<std::string> suggested_;
  std::unordered_set<std::string> libraries_;
  std::uint32_t object_ = 0;                ///< the animated name `o` says, 0 if it is none
  std::uint32_t group_ = 0;                 ///< the first animated name `g` says
  NameIndex material_ids_;                  ///< into usemtl_
  std::vector<NamedPlace> usemtl_;          ///< every name usemtl says
  std::vector<std::uint32_t> material_of_;  ///< [usemtl_] into obj_.materials, kNoIndex before the first face
  std::uint32_t usemtl_now_ = kNoIndex;
  std::uint32_t default_material_ = kNoIndex;
};

}  // namespace engine
