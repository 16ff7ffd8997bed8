#include "server/settings.h"

#include <gtest/gtest.h>

#include <fstream>

#include "server/config.h"
#include "tests/support/temporary_folder.h"

namespace server {
namespace {

using Words = std::vector<std::string>;

api::Result<Words> settings(std::vector<std::string_view> argv, std::vector<std::string_view> environment) {
  return with_settings(argv, environment, option_names());
}

class SettingsFile : public ::testing::Test {
 protected:
  std::string write(std::string_view text) {
    const auto path = folder_.path() / "keylume.conf";
    std::ofstream(path) << text;
    return path.string();
  }

  tests::TemporaryFolder folder_;
};

TEST(Settings, EveryOptionHasAVariable) {
  for (const OptionName& option : option_names()) {
    const std::string value = option.kind == OptionKind::flag ? "true" : "7";
    const std::string variable = variable_of(option.name) + "=" + value;
    const auto words = settings({}, {variable});
    ASSERT_TRUE(words) << words.error().message;
    const std::string word(option.name);
    EXPECT_EQ(*words, Words{option.kind == OptionKind::flag ? word : word + "=7"});
  }
  EXPECT_EQ(variable_of("--max-upload-bytes"), "KEYLUME_MAX_UPLOAD_BYTES");
}

TEST_F(SettingsFile, TheCommandLineComesBeforeTheEnvironmentAndThatBeforeTheFile) {
  const std::string config = "KEYLUME_CONFIG=" + write("# ours\nlog = json\n\nblob-hours=5\n data = file \n");
  const auto words = settings({"--data", "line"}, {"KEYLUME_DATA=variable", "KEYLUME_BLOB_HOURS=6", config});
  ASSERT_TRUE(words) << words.error().message;
  EXPECT_EQ(*words, (Words{"--log=json", "--blob-hours=6", "--data", "line"}));
}

TEST(Settings, AFlagOfTheEnvironmentCanBeTakenBackOnTheCommandLine) {
  const std::string_view open = "KEYLUME_OPS_OPEN=true";
  EXPECT_EQ(*settings({}, {open}), (Words{"--ops-open"}));
  for (const char* word : {"--no-ops-open", "--ops-open=false"}) {
    const auto words = settings({word}, {open});
    ASSERT_TRUE(words);
    EXPECT_EQ(*words, Words{word});
    const auto config = parse_options(std::vector<std::string_view>{"--ops-open", words->front()});
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_FALSE(config->ops_open) << word;
  }
  EXPECT_TRUE(parse_options(std::vector<std::string_view>{"--ops-open=yes"})->ops_open);
  EXPECT_FALSE(parse_options(std::vector<std::string_view>{"--ops-open=perhaps"}));
  EXPECT_FALSE(parse_options(std::vector<std::string_view>{"--no-data"})) << "only flags";
  EXPECT_FALSE(parse_options(std::vector<std::string_view>{"--no-evict=true"}));
}

TEST_F(SettingsFile, TheFileMayBeNamedOnTheCommandLine) {
  const std::string path = write("evict = yes\ninsecure-public = no\n");
  EXPECT_EQ(*settings({"--config", path}, {}), (Words{"--evict"}));
  EXPECT_EQ(*settings({"--config=" + path, "--evict"}, {}), (Words{"--evict"}));
}

TEST_F(SettingsFile, NamesInAListAreSeparatedByCommasOrSpacesOrOnLinesOfTheirOwn) {
  const std::string path = write("public-host = a.example, b.example\npublic-host = c.example\n");
  const Words all{"--public-host=a.example", "--public-host=b.example", "--public-host=c.example"};
  EXPECT_EQ(*settings({"--config", path}, {}), all);
  EXPECT_EQ(*settings({}, {"KEYLUME_PUBLIC_HOST=a.example,b.example c.example"}), all);
}

TEST_F(SettingsFile, WhatIsWrongIsNamedWithItsPlace) {
  const std::pair<std::string_view, std::string_view> cases[]{
      {"log = json\nno-such = 1\n", ":2: 'no-such' is not an option"},
      {"log json\n", ":1: not 'name = value'"},
      {"log = json\nlog = text\n", ":2: 'log' is there twice"},
      {"evict = perhaps\n", "evict: must be true or false"},
      {"config = other\n", ":1: 'config' is not an option"},
  };
  for (const auto& [text, message] : cases) {
    const auto words = settings({"--config", write(text)}, {});
    ASSERT_FALSE(words) << text;
    EXPECT_NE(words.error().message.find(message), std::string::npos) << words.error().message;
  }
  EXPECT_FALSE(settings({"--config", write(std::string(65'537, '#'))}, {})) << "64 KiB at most";
  EXPECT_TRUE(settings({"--config", write(std::string(65'536, '#'))}, {}));
  EXPECT_FALSE(settings({"--config", write(std::string(1'001, '\n'))}, {})) << "1000 lines at most";
  EXPECT_TRUE(settings({"--config", write(std::string(1'000, '\n'))}, {}));
  EXPECT_FALSE(settings({"--config"}, {}));
  EXPECT_EQ(settings({"--config", "/nonexistent"}, {}).error().fault, api::Fault::not_found);
}

TEST(Settings, AnEmptyVariableIsNoneAndOthersAreLeftAlone) {
  EXPECT_EQ(*settings({"--evict"}, {"KEYLUME_DATA=", "KEYLUME_CONFIG=", "KEYLUME_ELSE=1", "PATH=/bin"}),
            Words{"--evict"});
  const auto wrong = settings({}, {"KEYLUME_EVICT=perhaps"});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message, "KEYLUME_EVICT: must be true or false");
}

}  // namespace
}  // namespace server
