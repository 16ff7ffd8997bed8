#include "engine/scene/obj_file.h"

#include <algorithm>

#include "engine/scene/obj_reader.h"

namespace engine {
namespace {

constexpr std::size_t kSuggestionsMax = 2000;
constexpr std::uint64_t kStatementsPerPoll = 10'000;  // a few milliseconds

bool is_known_but_ignored(std::string_view keyword) {
  constexpr std::array<std::string_view, 32> kKeywords{
      "l",     "p",     "vp",   "cstype", "deg",      "bmat",       "step",      "curv",
      "curv2", "surf",  "parm", "trim",   "hole",     "scrv",       "sp",        "end",
      "con",   "mg",    "lod",  "bevel",  "c_interp", "d_interp",   "maplib",    "usemap",
      "ctech", "stech", "call", "csh",    "bzp",      "shadow_obj", "trace_obj", "vc"};
  return std::find(kKeywords.begin(), kKeywords.end(), keyword) != kKeywords.end();
}

}  // namespace

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
