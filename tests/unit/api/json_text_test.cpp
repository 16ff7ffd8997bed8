#include "api/json/json_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

namespace api {
namespace {

/// The one violation of a document that cannot be read.
Violation violation_of(std::string_view bytes, const JsonLimits& limits = {}) {
  const auto json = parse_json(bytes, "some.json", limits);
  EXPECT_FALSE(json);
  if (json) return {};
  EXPECT_EQ(json.error().violations.size(), 1u);
  return json.error().violations.at(0);
}

TEST(ParseJson, NamesLineAndColumnWhereTheTextBreaksOff) {
  const Violation violation = violation_of("{\n  \"a\": [1,\n  2");
  EXPECT_EQ(violation.code, "syntax");
  EXPECT_EQ(violation.file, "some.json");
  EXPECT_EQ(violation.pointer, "");
  EXPECT_EQ(violation.line, 3u);
  EXPECT_EQ(violation.column, 4u);
}

TEST(ParseJson, NamesTheOffendingCharacter) {
  const Violation violation = violation_of("{\"a\": 1,\n \"b\": ?}");
  EXPECT_EQ(std::pair(violation.line, violation.column), std::pair(2u, 7u));
  EXPECT_EQ(std::pair(violation_of("{\"a\":1,}").line, violation_of("{\"a\":1,}").column), std::pair(1u, 8u));
}

TEST(ParseJson, RefusesWhatIsNoJson) {
  for (const char* text : {"", " ", "NaN", "{\"a\":NaN}", "Infinity", "{'a':1}", "{\"a\":1} x", "// c\n{}",
                           "[01]", "[1,]", "\"\\x\"", "\"tab\there\""})
    EXPECT_EQ(violation_of(text).code, "syntax") << text;
}

TEST(ParseJson, RefusesBytesThatAreNotUtf8) {
  for (const char* text :
       {"\"\xff\"", "\"\xc0\xaf\"", "\"\xed\xa0\x80\"", "\"\xf4\x90\x80\x80\"", "\"\xe2\x82\""}) {
    const Violation violation = violation_of(text);
    EXPECT_EQ(violation.code, "syntax");
    EXPECT_EQ(violation.detail.find('\xff'), std::string::npos) << "the offending bytes are not repeated";
  }
}

TEST(ParseJson, NumbersBeyondADoubleAreOutOfRange) {
  const Violation violation = violation_of("{\"a\":[0,\n1e999]}");
  EXPECT_EQ(violation.code, "out_of_range");
  EXPECT_EQ(violation.pointer, "/a/1");
  EXPECT_EQ(violation.line, 2u);
}

TEST(ParseJson, DepthIsLimitedBeforeTheStackCouldRunOut) {
  const std::string fits = std::string(64, '[') + std::string(64, ']');
  EXPECT_TRUE(parse_json(fits, "some.json"));
  const Violation violation = violation_of("[" + fits + "]");
  EXPECT_EQ(violation.code, "too_deep");
  EXPECT_EQ(std::pair(violation.line, violation.column), std::pair(1u, 65u));
  EXPECT_EQ(violation_of(std::string(100'000, '[')).code, "too_deep");
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_EQ(violation_of(objects).code, "too_deep");
}

TEST(ParseJson, BracketsInStringsAreNoDepth) {
  EXPECT_TRUE(parse_json("\"" + std::string(100, '[') + "\\\"" + std::string(100, '{') + "\"", "some.json"));
}

TEST(ParseJson, SizeAndNumberOfValuesAreLimited) {
  EXPECT_EQ(violation_of("[1,2,3]", {.bytes = 6}).code, "too_large");
  EXPECT_TRUE(parse_json("[1,2,3]", "some.json", {.bytes = 7, .depth = 1, .values = 4}));
  EXPECT_EQ(violation_of("[1,2,3]", {.values = 3}).code, "too_many");
}

TEST(ParseJson, NamesEveryRepeatedMember) {
  const auto json = parse_json(R"({"a":{"b":1,"b":2},"c":[0,{"d":{},"d":[]}],"a":1})", "some.json");
  ASSERT_FALSE(json);
  std::vector<std::string> pointers;
  for (const Violation& violation : json.error().violations) {
    EXPECT_EQ(violation.code, "duplicate_key");
    pointers.push_back(violation.pointer);
  }
  EXPECT_EQ(pointers, (std::vector<std::string>{"/a/b", "/c/1/d", "/a"}));
}

TEST(ParseJson, TheSameNameInDifferentObjectsIsNoRepetition) {
  EXPECT_TRUE(parse_json(R"([{"a":1},{"a":{"a":1}}])", "some.json"));
}

TEST(JsonText, NeverThrows) {
  EXPECT_EQ(json_text("a\xff"), "\"a\xef\xbf\xbd\"");
  EXPECT_EQ(json_text(std::numeric_limits<double>::quiet_NaN()), "null");
}

TEST(ProblemJson, CarriesTheErrorsAndWhereTheyAre) {
  const Error error{Fault::invalid_request,
                    "two things",
                    {{"animation.json", "", 0, 0, "wrong_type", "must be an object"},
                     {"scene.obj", "", 7, 3, "index_out_of_range", "is 9, but there are 4"}}};
  const auto problem = ParsedJson::parse(problem_json(error, 422, "Unprocessable Content", "/v1/jobs"));
  EXPECT_EQ(problem, ParsedJson::parse(R"({"type":"urn:keylume:problem:invalid-request",
      "title":"Unprocessable Content","status":422,"detail":"two things","instance":"/v1/jobs","errors":[
      {"file":"animation.json","pointer":"","code":"wrong_type","detail":"must be an object"},
      {"file":"scene.obj","line":7,"column":3,"code":"index_out_of_range","detail":"is 9, but there are 4"}]})"));
}

TEST(ProblemJson, EveryFaultHasATypeOfItsOwn) {
  std::set<std::string> types;
  const std::vector faults{Fault::invalid_request,  Fault::not_found, Fault::wrong_state,
                           Fault::out_of_resources, Fault::stopped,   Fault::internal,
                           Fault::disk_full};
  for (const Fault fault : faults)
    types.insert(ParsedJson::parse(problem_json({fault, "", {}}, 500, "")).at("type").get<std::string>());
  EXPECT_EQ(types.size(), faults.size());
}

TEST(ProblemJson, SurvivesNamesThatAreNotUtf8) {
  const Error error{Fault::invalid_request, "\xff", {{"\xfe.mtl", "", 1, 1, "syntax", "\xfd"}}};
  EXPECT_NO_THROW(
      ParsedJson::parse(problem_json(error, 422, "")).at("errors").at(0).at("file").get<std::string>());
}

}  // namespace
}  // namespace api
