// Vertices, texture coordinates, normals and faces.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/scene/obj_reader.h"

namespace engine {
namespace {

constexpr std::uint32_t kCornersMin = 3;
constexpr std::uint32_t kCornersMax = 64;
constexpr double kCoordinateMax = 1e7;  // single precision leaves 1 unit there
constexpr double kUvMax = 1e30;         // beyond, single precision has no number; it repeats anyway
constexpr std::array<std::string_view, kind_count> kKindNames{"vertices", "texture coordinates", "normals"};

/// Indices of corners that have one, for corners since the first that has. `at` is the corner's number.
void add_index(std::vector<std::uint32_t>& indices, std::size_t at, std::int64_t one_based) {
  if (one_based == 0 && indices.empty()) return;
  indices.resize(at, kNoIndex);
  indices.push_back(one_based == 0 ? kNoIndex : static_cast<std::uint32_t>(one_based - 1));
}

/// As std::from_chars, for the few digits of nearly every index: null where there are none or more.
const char* parse_few_digits(const char* at, const char* end, std::int64_t& number) {
  const char* const last = end - at > 9 ? at + 9 : end;
  std::uint32_t value = 0;
  const char* c = at;
  for (; c < last; ++c) {
    const auto digit = static_cast<unsigned>(*c - '0');
    if (digit > 9) break;
    value = 10 * value + digit;
  }
  if (c == at || (c == last && last != end)) return nullptr;
  number = value;
  return c;
}

}  // namespace

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
  const char* const plain = parse_few_digits(at, end, index);
  if (plain && index > 0 && (!final_counts_ || index <= static_cast<std::int64_t>((*final_counts_)[kind]))) {
    at = plain;
    highest_[kind] = std::max(highest_[kind], static_cast<std::uint64_t>(index));
    return true;
  }
  return take_rare_index(word, at, kind, index);
}

/// The same, of an index that is wrong or not just a few digits.
bool ObjReader::take_rare_index(const Token& word, const char*& at, IndexKind kind, std::int64_t& index) {
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

}  // namespace engine
