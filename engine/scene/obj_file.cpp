#include "engine/scene/obj_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace engine {
namespace {

constexpr std::uint32_t kCornersMin = 3;
constexpr std::uint32_t kCornersMax = 64;
constexpr double kCoordinateMax = 1e7;  // single precision leaves 1 unit there
constexpr double kUvMax = 1e30;         // beyond, single precision has no number; it repeats anyway
constexpr std::size_t kSuggestionsMax = 2000;
constexpr std::uint64_t kStatementsPerPoll = 10'000;  // a few milliseconds

/// What an index of a face corner counts: v, vt, vn.
enum IndexKind { position, texture, normal, kind_count };
constexpr std::array<std::string_view, kind_count> kKindNames{"vertices", "texture coordinates", "normals"};
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

api::Error ObjReader::beyond_limit(std::uint32_t line, const char* what, std::size_t limit) const {
  const std::string detail = "more than " + std::to_string(limit) + " " + what;
  return {api::Fault::out_of_resources,
          violations_.file + " is larger than this service allows",
          {{violations_.file, "", line, line > 0 ? 1u : 0u, "limit_exceeded", detail}}};
}

api::Result<ObjFile> ObjReader::read(const std::filesystem::path& file) {
  StatementReader reader(file, limits_.line_bytes);
  if (!reader.is_open())
    return api::Error{api::Fault::invalid_request,
                      violations_.file + " cannot be opened",
                      {{violations_.file, "", 0, 0, "missing_file", "there is no such file in the job"}}};
  Statement statement;
  for (std::uint64_t count = 0; !violations_.full(); ++count) {
    if (count % kStatementsPerPoll == 0 && stop_requested_())
      return api::Error{api::Fault::stopped, "stopped while reading " + violations_.file};
    switch (reader.next(statement)) {
      case ReadStep::end:
        if (!obj_.corner_uvs.empty()) obj_.corner_uvs.resize(obj_.corners.size(), kNoIndex);
        if (!obj_.corner_normals.empty()) obj_.corner_normals.resize(obj_.corners.size(), kNoIndex);
        return std::move(obj_);
      case ReadStep::too_long:
        return beyond_limit(statement.line, "bytes in one statement", limits_.line_bytes);
      case ReadStep::failed:
        return api::Error{api::Fault::internal, "reading " + violations_.file + " failed"};
      case ReadStep::statement:
        if (const api::Status taken = take(statement); !taken) return taken.error();
    }
  }
  return std::move(obj_);
}

bool is_known_but_ignored(std::string_view keyword) {
  constexpr std::array<std::string_view, 32> kKeywords{
      "l",     "p",     "vp",   "cstype", "deg",      "bmat",       "step",      "curv",
      "curv2", "surf",  "parm", "trim",   "hole",     "scrv",       "sp",        "end",
      "con",   "mg",    "lod",  "bevel",  "c_interp", "d_interp",   "maplib",    "usemap",
      "ctech", "stech", "call", "csh",    "bzp",      "shadow_obj", "trace_obj", "vc"};
  return std::find(kKeywords.begin(), kKeywords.end(), keyword) != kKeywords.end();
}

api::Status ObjReader::take(const Statement& statement) {
  Tokens words(statement);
  Token keyword;
  if (!words.next(keyword)) return api::Done{};
  const std::string_view key = keyword.text;
  if (key == "v") {
    take_vertex(words, keyword);
    if (obj_.vertices.size() > limits_.vertices)
      return beyond_limit(keyword.line, "vertices", limits_.vertices);
  } else if (key == "f") {
    take_face(words, keyword);
    if (obj_.polygons.size() > limits_.polygons)
      return beyond_limit(keyword.line, "polygons", limits_.polygons);
  } else if (key == "vn") {
    take_normal(words, keyword);
    if (obj_.normals.size() > limits_.vertices)
      return beyond_limit(keyword.line, "normals", limits_.vertices);
  } else if (key == "vt") {
    take_uv(words, keyword);
    if (obj_.uvs.size() > limits_.vertices)
      return beyond_limit(keyword.line, "texture coordinates", limits_.vertices);
  } else if (key == "o") {
    take_object(words);
  } else if (key == "g") {
    take_groups(words);
  } else if (key == "usemtl") {
    return take_material(words, keyword);
  } else if (key == "mtllib") {
    take_libraries(words, keyword);
  } else if (is_known_but_ignored(key)) {
    obj_.ignored.add(key);
  } else if (key != "s") {  // smoothing groups: normals say it better
    violations_.add(keyword, "syntax", excerpt(key) + " is not a statement of an OBJ file");
  }
  return api::Done{};
}

/// Reads words up to the end of the statement. Answers how many there were; `good` only if all are numbers.
std::size_t ObjReader::read_numbers(Tokens& words, std::array<double, 8>& values, bool& good) {
  good = true;
  std::size_t count = 0;
  for (Token word; words.next(word); ++count) {
    double ignored = 0;
    good &= read_number(word, count < values.size() ? values[count] : ignored, violations_);
  }
  return count;
}

void ObjReader::take_vertex(Tokens& words, const Token& keyword) {
  std::array<double, 8> values{};
  std::size_t count = 0;
  Token word;
  bool good = true;
  for (; words.next(word); ++count) {
    if (count == values.size()) break;
    good &= read_number(word, values[count], violations_);
    const double coordinate = std::abs(values[count]);
    if (good && count < 3 && std::max(coordinate, coordinate * metres_per_unit_) > kCoordinateMax) {
      violations_.add(word, "out_of_range", excerpt(word.text) + " is beyond 1e7 units or 1e7 m");
      good = false;
    }
  }
  // x y z, with a weight, or with a colour, or both
  if (good && count != 3 && count != 4 && count != 6 && count != 7)
    violations_.add(keyword, "syntax",
                    "a vertex has 3 coordinates, here are " + std::to_string(count) + " numbers");
  if (count >= 6) obj_.ignored.add("vertex colour");
  const auto metres = [&](double coordinate) { return static_cast<float>(coordinate * metres_per_unit_); };
  obj_.vertices.push_back(good ? Vec3{metres(values[0]), metres(values[1]), metres(values[2])} : Vec3{});
  ++counts_[position];
}

/// Zeros where the statement is wrong or says no more.
std::array<double, 8> ObjReader::take_vector(Tokens& words, const Token& keyword, std::size_t fewest,
                                             std::size_t most) {
  std::array<double, 8> values{};
  bool good = true;
  const std::size_t count = read_numbers(words, values, good);
  if (good && (count < fewest || count > most)) {
    violations_.add(keyword, "syntax",
                    excerpt(keyword.text) + " takes " + std::to_string(fewest) +
                        (most > fewest ? " to " + std::to_string(most) : "") + " numbers, here are " +
                        std::to_string(count));
    good = false;
  }
  return good ? values : std::array<double, 8>{};
}

void ObjReader::take_uv(Tokens& words, const Token& keyword) {
  const auto values = take_vector(words, keyword, 1, 3);
  const auto coordinate = [&](int i) { return static_cast<float>(std::clamp(values[i], -kUvMax, kUvMax)); };
  obj_.uvs.push_back({coordinate(0), coordinate(1)});
  ++counts_[texture];
}

/// Unit, or zero: files hold normals of any length.
void ObjReader::take_normal(Tokens& words, const Token& keyword) {
  const auto values = take_vector(words, keyword, 3, 3);
  const double length = std::hypot(values[0], values[1], values[2]);
  const auto part = [&](int i) {
    return std::isfinite(length) && length > 0 ? static_cast<float>(values[i] / length) : 0.0f;
  };
  obj_.normals.push_back({part(0), part(1), part(2)});
  ++counts_[normal];
}

/// Reads the index at `at` and moves past it. `index` becomes 1-based. An index that lies outside what there
/// is becomes a violation.
bool ObjReader::take_index(const Token& word, const char*& at, IndexKind kind, std::int64_t& index) {
  const char* const end = word.text.data() + word.text.size();
  const auto [stop, problem] = std::from_chars(at, end, index);
  Token here = word;
  here.column += static_cast<std::uint32_t>(at - word.text.data());
  if (problem == std::errc::invalid_argument) {
    violations_.add(here, "syntax", excerpt(word.text) + " is not a corner: v, v/vt, v//vn or v/vt/vn");
    return false;
  }
  at = stop;
  const std::uint64_t known = final_counts_ ? (*final_counts_)[kind] : counts_[kind];
  const bool overflow = problem == std::errc::result_out_of_range;
  if (!overflow && index < 0) index += static_cast<std::int64_t>(counts_[kind]) + 1;  // -1 is the latest
  const bool too_high = final_counts_ ? index > static_cast<std::int64_t>(known) : index > kNoIndex - 1;
  if (overflow || index <= 0 || too_high) {
    violations_.add(here, "index_out_of_range",
                    excerpt(word.text) + ": there are " + std::to_string(known) + " " +
                        std::string(kKindNames[kind]) + (final_counts_ ? "" : " so far") +
                        "; indices count from 1, or back from -1");
    return false;
  }
  highest_[kind] = std::max(highest_[kind], static_cast<std::uint64_t>(index));
  return true;
}

/// Indices of corners that have one, for corners since the first that has. `at` is the corner's number.
void add_index(std::vector<std::uint32_t>& indices, std::size_t at, std::int64_t one_based) {
  if (one_based == 0 && indices.empty()) return;
  indices.resize(at, kNoIndex);
  indices.push_back(one_based == 0 ? kNoIndex : static_cast<std::uint32_t>(one_based - 1));
}

void ObjReader::add_corner(const std::array<std::int64_t, kind_count>& index) {
  add_index(obj_.corner_uvs, obj_.corners.size(), index[texture]);
  add_index(obj_.corner_normals, obj_.corners.size(), index[normal]);
  obj_.corners.push_back(static_cast<std::uint32_t>(index[position] - 1));
}

/// Those from `first` on.
void ObjReader::drop_corners(std::size_t first) {
  obj_.corners.resize(first);
  if (obj_.corner_uvs.size() > first) obj_.corner_uvs.resize(first);
  if (obj_.corner_normals.size() > first) obj_.corner_normals.resize(first);
}

/// v, v/vt, v//vn or v/vt/vn.
bool ObjReader::take_corner(const Token& word) {
  const char* at = word.text.data();
  const char* const end = at + word.text.size();
  std::array<std::int64_t, kind_count> index{};  // 1-based; 0: not given
  if (!take_index(word, at, position, index[position])) return false;
  const auto more = [&] { return end - at > 1 && *at == '/'; };
  if (more() && *++at != '/' && !take_index(word, at, texture, index[texture])) return false;
  if (more() && !take_index(word, ++at, normal, index[normal])) return false;
  if (at == end) {
    add_corner(index);
    return true;
  }
  Token here = word;
  here.column += static_cast<std::uint32_t>(at - word.text.data());
  violations_.add(here, "syntax", excerpt(word.text) + " is not a corner: v, v/vt, v//vn or v/vt/vn");
  return false;
}

void ObjReader::take_face(Tokens& words, const Token& keyword) {
  ++obj_.face_statements;
  const std::size_t first = obj_.corners.size();
  std::uint32_t count = 0;
  bool good = true;
  for (Token word; words.next(word); ++count) {
    if (count == kCornersMax) {
      violations_.add(word, "too_many_corners", "a polygon has at most 64 corners; cut it into smaller ones");
      good = false;
      break;
    }
    good &= take_corner(word);
  }
  if (count < kCornersMin) {
    violations_.add(keyword, "too_few_corners",
                    "a polygon has at least 3 corners, this one has " + std::to_string(count));
    good = false;
  }
  if (good)
    finish_polygon(first, keyword);
  else
    drop_corners(first);
}

void ObjReader::finish_polygon(std::size_t first, const Token& keyword) {
  Polygon polygon;
  polygon.first_corner = static_cast<std::uint32_t>(first);
  polygon.corner_count = static_cast<std::uint32_t>(obj_.corners.size() - first);
  polygon.object = group_ != 0 ? group_ : object_;
  polygon.material = material_of_face();
  polygon.obj_line = keyword.line;
  obj_.polygons.push_back(polygon);
}

/// The number of the current material, new at its first face: usemtl without faces does not count.
std::uint32_t ObjReader::material_of_face() {
  std::uint32_t& material = usemtl_now_ == kNoIndex ? default_material_ : material_of_[usemtl_now_];
  if (material == kNoIndex) {
    material = static_cast<std::uint32_t>(obj_.materials.size());
    obj_.materials.push_back(usemtl_now_ == kNoIndex ? NamedPlace{} : usemtl_[usemtl_now_]);
  }
  return material;
}

/// Notes that there is an o or g of this name; answers the animated name it is, 0 if none.
std::uint32_t ObjReader::see_unit(const std::string& name) {
  if (suggested_.size() < kSuggestionsMax && suggested_.insert(name).second)
    obj_.o_and_g_names.push_back(name);
  const auto animated = animated_.find(name);
  if (animated == animated_.end()) return 0;
  obj_.animated_seen[animated->second] = true;
  return animated->second;
}

void ObjReader::take_object(Tokens& words) {
  object_ = see_unit(utf8_name(words.rest().text));
}

/// `g a b` lists groups; `g front door` may also be one name with a space, as some exporters write it.
void ObjReader::take_groups(Tokens& words) {
  const Token all = words.rest();
  group_ = see_unit(utf8_name(all.text));
  if (all.text.find_first_of(" \t") == all.text.npos) return;
  words.rewind_to(all);
  for (Token word; words.next(word);) {
    const std::uint32_t group = see_unit(utf8_name(word.text));
    if (group_ == 0) group_ = group;
  }
}

api::Status ObjReader::take_material(Tokens& words, const Token& keyword) {
  const Token name = words.rest();
  if (name.text.empty()) {
    violations_.add(keyword, "syntax", "'usemtl' needs the name of a material");
    return api::Done{};
  }
  const auto [entry, is_new] =
      material_ids_.try_emplace(utf8_name(name.text), static_cast<std::uint32_t>(usemtl_.size()));
  usemtl_now_ = entry->second;
  if (is_new) {
    usemtl_.push_back({entry->first, name.line, name.column});
    material_of_.push_back(kNoIndex);
  }
  if (usemtl_.size() > limits_.materials) return beyond_limit(name.line, "materials", limits_.materials);
  return api::Done{};
}

/// The whole rest is kept as one name: load_scene knows which files there are, and tells "a b.mtl" from two.
void ObjReader::take_libraries(Tokens& words, const Token& keyword) {
  const Token names = words.rest();
  if (names.text.empty())
    violations_.add(keyword, "syntax", "'mtllib' needs the name of a file");
  else if (libraries_.size() < limits_.materials && libraries_.insert(std::string(names.text)).second)
    obj_.libraries.push_back({std::string(names.text), names.line, names.column});
}

}  // namespace

api::Result<ObjFile> read_obj_file(const std::filesystem::path& file, std::span<const std::string> animated,
                                   double metres_per_unit, const SceneLimits& limits,
                                   FileViolations& violations, const std::function<bool()>& stop_requested) {
  const std::size_t violations_before = violations.all.size();
  ObjReader reader(animated, metres_per_unit, limits, violations, stop_requested, std::nullopt);
  api::Result<ObjFile> obj = reader.read(file);
  if (!obj || violations.full() || !reader.trust_misplaced()) return obj;
  violations.all.resize(violations_before);
  obj = ObjFile{};
  ObjReader again(animated, metres_per_unit, limits, violations, stop_requested, reader.counts());
  return again.read(file);
}

}  // namespace engine
