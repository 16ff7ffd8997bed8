// What whoever sent a job calls its files.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace api {

/// Of the files that are kept under names of ours: that name -> the one given, where it is another.
/// {"scene.obj": "hall.obj"}
using GivenNames = std::map<std::string, std::string>;

/// JOB_FOLDER/names.json. Without it the files are called as they are kept.
inline constexpr std::string_view kGivenNamesFile = "names.json";
inline constexpr std::size_t kGivenNamesBytesMax = 8192;

// Defined in api/json/.
std::string given_names_json(const GivenNames& names);
/// What is no such document says nothing.
GivenNames parse_given_names(std::string_view bytes);

/// `text` with every file called as it was given.
std::string with_given_names(std::string_view text, const GivenNames& names);

}  // namespace api
