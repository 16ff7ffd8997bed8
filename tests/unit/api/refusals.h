// What is wrong with a document, in few words.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "api/job_request.h"

namespace api {

/// "code pointer" of every violation, in order; empty when the document is accepted.
inline std::vector<std::string> refusals(std::string_view document) {
  std::vector<std::string> list;
  const auto request = parse_job_request(document);
  if (request) return list;
  for (const Violation& violation : request.error().violations) {
    EXPECT_EQ(violation.file, "animation.json");
    EXPECT_FALSE(violation.detail.empty());
    list.push_back(violation.code + " " + violation.pointer);
  }
  return list;
}

using List = std::vector<std::string>;

}  // namespace api
