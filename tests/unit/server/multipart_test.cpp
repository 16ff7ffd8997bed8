#include "server/http/multipart.h"

#include <gtest/gtest.h>

#include <vector>

namespace server {
namespace {

struct Part {
  std::string field;
  std::string file_name;
  std::string content;
  bool operator==(const Part&) const = default;
};

struct Parsed {
  std::vector<Part> parts;
  bool complete = false;
  std::string error;
};

/// Feeds `body` in pieces of `piece_bytes`.
Parsed parse(std::string_view body, std::size_t piece_bytes = 1 << 20) {
  Parsed parsed;
  MultipartParser parser("edge", {[&](auto field, auto name) {
                                    parsed.parts.push_back({std::string(field), std::string(name), ""});
                                    return true;
                                  },
                                  [&](auto bytes) {
                                    parsed.parts.back().content += bytes;
                                    return true;
                                  }});
  while (!body.empty() && parser.feed(body.substr(0, piece_bytes)))
    body.remove_prefix(std::min(piece_bytes, body.size()));
  parsed.complete = parser.complete();
  parsed.error = parser.error();
  return parsed;
}

std::string part(std::string_view disposition, std::string_view content) {
  return "--edge\r\nContent-Disposition: " + std::string(disposition) +
         "\r\nContent-Type: text/plain\r\n\r\n" + std::string(content) + "\r\n";
}

TEST(Multipart, YieldsTheSamePartsHoweverTheBytesArrive) {
  // The content holds whatever might be taken for a boundary.
  const std::string tricky = "\r\n--edg\r\n-\r\n--\r\n--Edge\r\r\n--edge" + std::string("x");
  const std::string content = "v 0 0 0\r\n\r\n--edg" + std::string(300, 'a') + "\r\n-";
  const std::string body =
      part("form-data; name=\"scene\"; filename=\"a.obj\"", content) + part("form-data; name=\"empty\"", "") +
      part("form-data; name=\"last\"; filename=\"b.mtl\"", "\r\n") + "--edge--\r\nepilogue";
  const std::vector<Part> expected{{"scene", "a.obj", content}, {"empty", "", ""}, {"last", "b.mtl", "\r\n"}};
  for (std::size_t piece_bytes = 1; piece_bytes <= body.size(); ++piece_bytes) {
    const Parsed parsed = parse(body, piece_bytes);
    ASSERT_EQ(parsed.parts, expected) << piece_bytes;
    ASSERT_TRUE(parsed.complete) << piece_bytes;
  }
  EXPECT_FALSE(parse(part("form-data; name=\"a\"", tricky) + "--edge--").complete)
      << "a boundary that goes on with other letters is broken, not content";
}

TEST(Multipart, IsNotCompleteWhenCutAnywhere) {
  const std::string body = part("form-data; name=\"scene\"", "v 0 0 0") + "--edge--";
  for (std::size_t length = 0; length < body.size(); ++length)
    ASSERT_FALSE(parse(body.substr(0, length)).complete) << length;
  EXPECT_TRUE(parse(body).complete);
}

TEST(Multipart, SaysWhatIsBroken) {
  const std::pair<std::string, std::string> cases[]{
      {"preamble\r\n--edge\r\n", "begin"},
      {"--edge and more", "neither"},
      {"--edge\r\n\r\ncontent\r\n--edge--", "Content-Disposition"},
      {"--edge\r\nContent-Type: text/plain\r\n\r\n", "Content-Disposition"},
      {part("attachment; name=\"a\"", ""), "form-data"},
      {part("form-data; filename=\"a\"", ""), "name"},
      {part("form-data; name=\"a", ""), "name"},
      {"--edge\r\nContent-Disposition: form-data; name=\"" + std::string(10'000, 'a') + "\"\r\n\r\n",
       "too long"},
      {"--edge\r\n" + std::string(10'000, 'a'), "too long"},
  };
  for (const auto& [body, word] : cases) {
    const Parsed parsed = parse(body);
    EXPECT_FALSE(parsed.complete);
    EXPECT_NE(parsed.error.find(word), std::string::npos) << body.substr(0, 60) << " -> " << parsed.error;
  }
}

TEST(Multipart, StopsWhenTheSinkHasHadEnough) {
  int taken = 0;
  MultipartParser parser("edge", {[](auto, auto) { return true; }, [&](auto) { return ++taken < 1; }});
  EXPECT_FALSE(parser.feed(part("form-data; name=\"a\"", std::string(100, 'a'))));
  EXPECT_FALSE(parser.feed("more"));
  EXPECT_EQ(taken, 1);
  EXPECT_EQ(parser.error(), "");
}

TEST(HeaderParameter, ReadsQuotedEscapedAndBareValues) {
  const std::string header =
      R"(form-data; name="a;b=c" ; filename="say \"hi\" C:\dir\x.obj"; size=12;flag; last=z)";
  EXPECT_EQ(header_parameter(header, "name"), "a;b=c");
  EXPECT_EQ(header_parameter(header, "filename"), R"(say "hi" C:\dir\x.obj)");
  EXPECT_EQ(header_parameter(header, "SIZE"), "12");
  EXPECT_EQ(header_parameter(header, "last"), "z");
  EXPECT_EQ(header_parameter(header, "flag"), std::nullopt);
  EXPECT_EQ(header_parameter("form-data", "name"), std::nullopt);
  EXPECT_EQ(header_parameter("form-data; name=\"open", "name"), std::nullopt);
}

TEST(Multipart, TakesFileNamesInUtf8) {
  const Parsed parsed =
      parse(part("form-data; name=a; filename=x; filename*=UTF-8''h%C3%A4ll%2F..%2Fe.mtl", "") + "--edge--");
  ASSERT_EQ(parsed.parts.size(), 1u);
  EXPECT_EQ(parsed.parts[0].file_name, "h\xC3\xA4ll/../e.mtl") << "made safe by safe_base_name";
}

TEST(MultipartBoundary, ComesFromTheContentType) {
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("Multipart/Form-Data; charset=utf-8; boundary=\"a b\""), std::nullopt)
      << "a space";
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=\"abc\""), "abc");
  for (const char* type : {"", "multipart/form-data", "multipart/form-data; boundary=",
                           "multipart/form-datax; boundary=a", "application/json", "text/plain; boundary=a"})
    EXPECT_EQ(multipart_boundary(type), std::nullopt) << type;
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=" + std::string(71, 'a')), std::nullopt);
}

}  // namespace
}  // namespace server
