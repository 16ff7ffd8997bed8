// The schema is what users read, the parser is what they meet: every property, bound, default, and value of
// the schema is put to the parser, inside a document that is right but for the value in question.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "api/job_request.h"
#include "api/json/json_text.h"
#include "tests/unit/api/test_files.h"

namespace api {
namespace {

using Build = std::function<ParsedJson(const ParsedJson&)>;  ///< a value -> the whole document around it

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Right on its own, long enough for every key, with a camera for every image.
ParsedJson base_document() {
  ParsedJson document{{"frames", {{"count", kFramesMax}}}};
  const ParsedJson camera{{"position", {1, 2, 3}}, {"target", {0, 0, 0}}};
  document["cameras"]["main"] = camera;
  for (int i = 0; i < 20; ++i) document["cameras"]["camera_" + std::to_string(i)] = camera;
  return document;
}

/// Matrices are one per frame, so the last one given is repeated to the end.
void repeat_matrices(ParsedJson& object) {
  if (!object.is_object() || !object.contains("matrices")) return;
  auto& matrices = object["matrices"];
  if (matrices.is_array() && !matrices.empty())
    while (matrices.size() < kFramesMax) matrices.push_back(ParsedJson(matrices.back()));
}

/// Room for `value` below the bound that another member is, whose default is `usual`.
void raise_bound(ParsedJson& object, const char* value, const char* bound, double usual, double highest) {
  if (object.is_object() && object.contains(value) && !object.contains(bound) && object[value].is_number() &&
      object[value].get<double>() > usual)
    object[bound] = highest;
}

/// What holds only together with something else in the document gets that beside it.
ParsedJson fitted(ParsedJson document) {
  const auto object_named = [&](const char* section, const char* name) {
    return document.contains(section) && document[section].is_object() && document[section].contains(name);
  };
  if (object_named("objects", "main") || object_named("lights", "main"))
    document["objects"].emplace("car", ParsedJson::object());  // the parent of the schema's example
  if (document.contains("objects") && document["objects"].is_object())
    for (auto& object : document["objects"]) repeat_matrices(object);
  if (object_named("lights", "main"))
    raise_bound(document["lights"]["main"], "inner_degrees", "outer_degrees", 30, 90);
  if (document.contains("lighting"))
    raise_bound(document["lighting"], "moving_line_count", "line_count", 4e6, 1e9);
  return document;
}

/// The `i`th copy of an element that must differ from its neighbours.
ParsedJson copy_of(ParsedJson element, std::size_t i) {
  if (element.is_object() && element.contains("frame")) element["frame"] = i;
  if (element.is_object() && element.contains("camera")) element["camera"] = "camera_" + std::to_string(i);
  if (element.is_string() && i > 0) element = element.get<std::string>() + std::to_string(i);
  return element;
}

/// The same for the `i`th of some members: no light is in two groups.
ParsedJson member_of(const ParsedJson& value, std::size_t i) {
  return value.is_array() && value[0].is_string() ? ParsedJson::array({copy_of(value[0], i)}) : value;
}

class SchemaWalk {
 public:
  SchemaWalk() : schema_(ParsedJson::parse(read_file(source_path("api/schemas/job.schema.json")))) {}

  void run() {
    for (const auto& [name, property] : schema_["properties"].items()) {
      const auto build = [field = name](const ParsedJson& value) {
        ParsedJson document = base_document();
        document[field] = value;
        return document;
      };
      ParsedJson without = base_document();
      without.erase(name);
      if (name == "frames" || name == "cameras")
        continue_with(property, build, "/" + name);
      else
        visit_property(property, build, without, "/" + name);
    }
    expect_fields(schema_["properties"], {{"no_such_field", 1}}, "/");
  }
  int accepted() const { return accepted_; }
  int refused() const { return refused_; }

 private:
  ParsedJson resolved(const ParsedJson& schema) const {
    if (!schema.contains("$ref")) return schema;
    const auto reference = schema["$ref"].get<std::string>();
    ParsedJson target = resolved(schema_.at(ParsedJson::json_pointer(reference.substr(1))));
    for (const auto& [name, value] : schema.items())
      if (name != "$ref") target[name] = value;
    return target;
  }

  /// A value that is right, and not the default.
  ParsedJson example(const ParsedJson& given) const {
    const ParsedJson schema = resolved(given);
    if (schema.contains("examples")) return schema["examples"][0];
    if (schema.contains("const")) return schema["const"];
    if (schema.contains("enum"))
      return schema["enum"].back() == schema.value("default", ParsedJson()) ? schema["enum"][0]
                                                                            : schema["enum"].back();
    if (schema.contains("oneOf")) return example(schema["oneOf"].back());
    if (schema["type"] == "boolean") return !schema.value("default", false);
    if (schema["type"] == "object") return required_members(schema);
    if (schema["type"] == "array") return ParsedJson::array({example(schema["items"])});
    ADD_FAILURE() << "no example in " << schema.dump(2);
    return {};
  }
  ParsedJson required_members(const ParsedJson& schema) const {
    ParsedJson object = ParsedJson::object();
    if (schema.contains("required"))
      for (const auto& name : schema["required"])
        object[name.get<std::string>()] = example(schema["properties"][name.get<std::string>()]);
    return object;
  }

  JobRequest accept(const Build& build, const ParsedJson& value, const std::string& at) {
    ++accepted_;
    const auto request = parse_job_request(fitted(build(value)).dump());
    if (request) return *request;
    ADD_FAILURE() << at << ": the schema allows " << value.dump().substr(0, 200) << "\n"
                  << problem_json(request.error(), 422, "");
    return {};
  }
  void refuse(const Build& build, const ParsedJson& value, const std::string& at, const std::string& code) {
    ++refused_;
    const auto request = parse_job_request(fitted(build(value)).dump());
    ASSERT_FALSE(request) << at << ": the schema forbids " << value.dump().substr(0, 200);
    bool named = false;
    for (const Violation& violation : request.error().violations) named |= violation.code == code;
    EXPECT_TRUE(named) << at << ": expected the code " << code << " for " << value.dump().substr(0, 200)
                       << "\n"
                       << problem_json(request.error(), 422, "");
  }

  /// Nothing is read that the schema does not tell: the refusal of an unknown field lists those that are
  /// known.
  void expect_fields(const ParsedJson& properties, const ParsedJson& document, const std::string& at) {
    std::set<std::string> stated, known;
    for (const auto& [name, property] : properties.items()) stated.insert(name);
    const auto request = parse_job_request(fitted(document).dump());
    ASSERT_FALSE(request) << at;
    const std::string detail = request.error().violations.at(0).detail;
    const std::regex quoted("\"([^\"]+)\"");
    for (std::sregex_iterator match(detail.begin(), detail.end(), quoted), end; match != end; ++match)
      known.insert((*match)[1]);
    EXPECT_EQ(known, stated) << at << ": " << detail;
  }

  /// Heeded, and of the default that is stated; then what is inside it.
  void visit_property(const ParsedJson& given, const Build& build, const ParsedJson& without,
                      const std::string& at) {
    const ParsedJson schema = resolved(given);
    EXPECT_TRUE(schema.contains("description")) << at;
    const Build absent = [&](const ParsedJson&) { return without; };
    const JobRequest by_default = accept(absent, {}, at);
    const bool one_choice = schema.contains("enum") && schema["enum"].size() == 1;
    EXPECT_TRUE(one_choice || accept(build, example(schema), at) != by_default) << at << " is ignored";
    if (schema.contains("default")) {
      EXPECT_TRUE(accept(build, schema["default"], at) == by_default) << at << ": not the parser's default";
    }
    continue_with(schema, build, at);
  }

  void continue_with(const ParsedJson& given, const Build& build, const std::string& at, bool alone = true) {
    const ParsedJson schema = resolved(given);
    if (schema.contains("oneOf")) {
      for (std::size_t i = 0; i < schema["oneOf"].size(); ++i)
        continue_with(schema["oneOf"][i], build, at + "(" + std::to_string(i) + ")", false);
    } else if (schema.contains("const")) {
      visit_const(schema["const"], build, at);
    } else if (schema.contains("enum")) {
      visit_enum(schema, build, at);
    } else if (schema["type"] == "integer" || schema["type"] == "number") {
      visit_number(schema, build, at);
    } else if (schema["type"] == "boolean") {
      accept(build, true, at);
      accept(build, false, at);
      refuse(build, 1, at, "wrong_type");
    } else if (schema["type"] == "string") {
      visit_string(schema, build, at);
    } else if (schema["type"] == "array") {
      visit_array(schema, build, at);
    } else {
      ASSERT_EQ(schema["type"], "object") << at;
      visit_object(schema, build, at, alone);
    }
  }

  void visit_const(const ParsedJson& value, const Build& build, const std::string& at) {
    accept(build, value, at);
    if (value.is_number())
      refuse(build, value.get<int>() + 1, at, "not_affine");
    else
      refuse(build, value.get<std::string>() + "?", at, "unknown_value");
  }
  void visit_enum(const ParsedJson& schema, const Build& build, const std::string& at) {
    for (const auto& value : schema["enum"]) accept(build, value, at);
    refuse(build, "no such value", at, "unknown_value");
    refuse(build, 7, at, "wrong_type");
  }
  void visit_number(const ParsedJson& schema, const Build& build, const std::string& at) {
    const bool whole = schema["type"] == "integer";
    // The next number outwards (`away` from the range) or inwards of a bound.
    const auto next = [&](const ParsedJson& bound, double away) -> ParsedJson {
      if (whole) return bound.get<std::int64_t>() + (away > 0 ? 1 : -1);
      return std::nextafter(bound.get<double>(), away);
    };
    EXPECT_TRUE(schema.contains("maximum") || schema.contains("exclusiveMaximum"))
        << at << " has no upper bound";
    EXPECT_TRUE(schema.contains("minimum") || schema.contains("exclusiveMinimum"))
        << at << " has no lower bound";
    for (const auto& [name, away] : {std::pair("minimum", -kInfinity), std::pair("maximum", kInfinity)}) {
      if (!schema.contains(name)) continue;
      accept(build, schema[name], at);
      refuse(build, next(schema[name], away), at, "out_of_range");
    }
    for (const auto& [name, away] :
         {std::pair("exclusiveMinimum", -kInfinity), std::pair("exclusiveMaximum", kInfinity)}) {
      if (!schema.contains(name)) continue;
      accept(build, next(schema[name], -away), at);
      refuse(build, schema[name], at, "out_of_range");
    }
    refuse(build, false, at, "wrong_type");
    if (whole) refuse(build, schema["minimum"].get<double>() + 0.5, at, "wrong_type");
  }
  void visit_string(const ParsedJson& schema, const Build& build, const std::string& at) {
    accept(build, example(schema), at);
    refuse(build, 7, at, "wrong_type");
    if (schema.contains("maxLength")) {
      accept(build, std::string(schema["maxLength"].get<std::size_t>(), 'a'), at);
      refuse(build, std::string(schema["maxLength"].get<std::size_t>() + 1, 'a'), at, "bad_name");
    }
    if (schema.contains("pattern")) refuse(build, "bell\a", at, "bad_name");
    if (schema.contains("minLength")) refuse(build, "", at, "bad_name");
  }

  void visit_array(const ParsedJson& schema, const Build& build, const std::string& at) {
    refuse(build, "no array", at, "wrong_type");
    if (schema.contains("prefixItems")) {
      visit_prefix(schema, build, at);
      return;
    }
    ASSERT_TRUE(schema.contains("maxItems")) << at << " has no limit";
    const std::size_t most = schema["maxItems"], least = schema.value("minItems", std::size_t{0});
    // Numbers that belong together come with an example of the whole.
    const bool of_numbers = schema["items"].value("type", "") == "number";
    const ParsedJson whole = of_numbers ? schema["examples"][0] : ParsedJson::array();
    const ParsedJson item = of_numbers ? whole.back() : example(schema["items"]);
    const auto some = [&](std::size_t count) {
      ParsedJson array = whole;
      while (array.size() > count) array.erase(array.size() - 1);
      while (array.size() < count) array.push_back(copy_of(item, array.size()));
      return array;
    };
    if (schema.value("uniqueItems", false)) {
      refuse(build, {item, item}, at, "duplicate_value");
      if (schema["items"].value("type", "") == "string") accept(build, some(most), at);
      refuse(build, some(most + 1), at, "wrong_length");
    } else {
      accept(build, some(most), at);
      refuse(build, some(most + 1), at, "wrong_length");
    }
    if (least > 0) refuse(build, some(least - 1), at, "wrong_length");
    const std::size_t probed = std::max<std::size_t>(least, 1);
    const Build build_item = [&](const ParsedJson& value) {
      ParsedJson array = some(probed);
      array.back() = value;
      return build(array);
    };
    continue_with(schema["items"], build_item, at + "/-");
  }

  /// A 4 x 4 matrix. Of its nine numbers that turn and stretch none is free: the determinant binds them.
  void visit_prefix(const ParsedJson& schema, const Build& build, const std::string& at) {
    const ParsedJson matrix = schema["examples"][0];
    ASSERT_EQ(matrix.size(), schema["prefixItems"].size());
    for (const std::size_t i : {3, 7, 11, 12, 13, 14, 15}) {
      const Build build_item = [&](const ParsedJson& value) {
        ParsedJson array = matrix;
        array[i] = value;
        return build(array);
      };
      continue_with(schema["prefixItems"][i], build_item, at + "/" + std::to_string(i));
    }
    ParsedJson longer = matrix;
    longer.push_back(0);
    refuse(build, longer, at, "wrong_length");
  }

  void visit_object(const ParsedJson& schema, const Build& build, const std::string& at, bool alone) {
    ASSERT_TRUE(schema.contains("additionalProperties")) << at;
    if (schema["additionalProperties"].is_object()) return visit_names(schema, build, at);
    const ParsedJson minimal = required_members(schema);
    accept(build, minimal, at);
    ParsedJson with_unknown = minimal;
    with_unknown["no_such_field"] = 1;
    refuse(build, with_unknown, at, "unknown_field");
    if (alone) expect_fields(schema["properties"], build(with_unknown), at);
    // One of several forms may lack what makes it this form, and be another.
    if (alone) refuse(build, 7, at, "wrong_type");
    for (const auto& [name, property] : schema["properties"].items()) {
      const Build build_member = [&, field = name](const ParsedJson& value) {
        ParsedJson object = minimal;
        object[field] = value;
        return build(object);
      };
      ParsedJson without = minimal;
      without.erase(name);
      if (!minimal.contains(name)) {
        visit_property(property, build_member, build(without), at + "/" + name);
        continue;
      }
      if (alone) refuse(build, without, at + "/" + name, "missing");
      continue_with(property, build_member, at + "/" + name);
    }
  }

  /// Members of any name: its own limits on names and their number.
  void visit_names(const ParsedJson& schema, const Build& build, const std::string& at) {
    const ParsedJson value = example(schema["additionalProperties"]);
    const std::size_t most = schema["maxProperties"];
    ParsedJson members;
    for (std::size_t i = 0; i < most; ++i) members["name_" + std::to_string(i)] = member_of(value, i);
    accept(build, members, at);
    members["one_more"] = value;
    refuse(build, members, at, "too_many");
    if (schema.contains("minProperties")) refuse(build, ParsedJson::object(), at, "missing");
    refuse(build, 7, at, "wrong_type");

    const ParsedJson& names = schema["propertyNames"];
    refuse(build, {{"", value}}, at, "bad_name");
    refuse(build, {{"bell\a", value}}, at, "bad_name");
    const std::size_t longest =
        names.value("maxLength", std::size_t{64});  // of file names the pattern says 64
    accept(build, {{std::string(longest, 'a'), value}}, at);
    refuse(build, {{std::string(longest + 1, 'a'), value}}, at, "bad_name");

    const Build build_member = [&](const ParsedJson& member) { return build({{"main", member}}); };
    continue_with(schema["additionalProperties"], build_member, at + "/*");
  }

  ParsedJson schema_;
  int accepted_ = 0;
  int refused_ = 0;
};

TEST(JobSchema, SaysWhatTheParserDoes) {
  SchemaWalk walk;
  walk.run();
  // Far more than one of each per field: the walk went everywhere.
  EXPECT_GT(walk.accepted(), 300);
  EXPECT_GT(walk.refused(), 300);
}

TEST(JobSchema, EveryExampleAndPresetStatedInItIsTheParsers) {
  const auto schema = ParsedJson::parse(read_file(source_path("api/schemas/job.schema.json")));
  const auto description = schema["$defs"]["lighting"]["description"].get<std::string>();
  for (const auto& [name, preset] : {std::pair("draft", Preset::draft), std::pair("high", Preset::high)}) {
    const LightingOptions options = lighting_preset(preset), standard = lighting_preset(Preset::standard);
    std::string differences = std::string(name) + " - line_count " + std::to_string(options.line_count) +
                              ", moving_line_count " + std::to_string(options.moving_line_count) +
                              ", samples_per_light " + std::to_string(options.samples_per_light) +
                              ", patch_edge_m " + ParsedJson(options.patch_edge_m).dump() +
                              ", estimate_line_count " + std::to_string(options.estimate_line_count);
    if (options.tolerance != standard.tolerance)
      differences += ", tolerance " + ParsedJson(options.tolerance).dump();
    EXPECT_NE(description.find(differences), std::string::npos) << differences;
  }
}

}  // namespace
}  // namespace api
