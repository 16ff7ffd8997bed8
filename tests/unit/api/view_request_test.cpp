#include "api/view_request.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

api::ViewedJob job() {
  api::ViewedJob job;
  job.frame_count = 10;
  job.cameras["front"] = {};
  job.light_groups = {"ceiling", "other"};
  return job;
}

std::vector<std::string> refused(std::string_view text) {
  const auto view = api::parse_view_request(text, job());
  std::vector<std::string> found;
  if (view) return found;
  EXPECT_EQ(view.error().fault, api::Fault::invalid_request);
  for (const api::Violation& violation : view.error().violations)
    found.push_back(violation.pointer + " " + violation.code);
  std::sort(found.begin(), found.end());
  return found;
}

std::string canonical(std::string_view text) {
  const auto view = api::parse_view_request(text, job());
  EXPECT_TRUE(view) << text;
  return view ? view->canonical_json : std::string(text);
}

TEST(ViewRequest, ACameraIsEnough) {
  const auto view = api::parse_view_request(R"({"camera": "front"})", job());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->image.camera, "front");
  EXPECT_EQ(view->frames.size(), 10u);
  EXPECT_TRUE(view->image.png && !view->image.jpg && !view->image.exr && view->image.auto_exposure);
}

TEST(ViewRequest, ACameraOfItsOwnIsReadAsThoseOfJobs) {
  const auto view = api::parse_view_request(
      R"({"camera": {"position": [1, 2, 3], "target": [0, 0, 0], "vertical_fov_degrees": 60}, "frames": [2, 9]})",
      job());
  ASSERT_TRUE(view);
  ASSERT_TRUE(view->own_camera);
  EXPECT_EQ(view->frames, (std::vector<api::FrameIndex>{2, 9}));
  EXPECT_EQ(refused(R"({"camera": {"position": [1, 2], "fov": 3}})"),
            (std::vector<std::string>{"/camera/fov unknown_field", "/camera/position wrong_length",
                                      "/camera/target missing"}));
}

TEST(ViewRequest, LightsOfAGroupAreMadeAsBrightAsAsked) {
  const auto view = api::parse_view_request(
      R"({"camera": "front", "light_gains": {"ceiling": 2, "other": [1, 0.5, 0]}})", job());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->light_gains.at("ceiling"), (api::Vec3{2, 2, 2}));
  EXPECT_EQ(view->light_gains.at("other"), (api::Vec3{1, 0.5, 0}));
  EXPECT_EQ(canonical(R"({"camera": "front", "light_gains": {"ceiling": [2, 2, 2], "other": 1}})"),
            canonical(R"({"camera": "front", "light_gains": {"ceiling": 2}})"));
  EXPECT_EQ(canonical(R"({"camera": "front", "light_gains": {"ceiling": 1}})"),
            canonical(R"({"camera": "front"})"));
  EXPECT_NE(canonical(R"({"camera": "front", "light_gains": {"ceiling": 2}})"),
            canonical(R"({"camera": "front"})"));
  EXPECT_EQ(refused(R"({"camera": "front", "light_gains": {"celing": 1, "ceiling": -1, "other": [1, 2]}})"),
            (std::vector<std::string>{"/light_gains/ceiling out_of_range",
                                      "/light_gains/celing unknown_light_group",
                                      "/light_gains/other wrong_length"}));
}

TEST(ViewRequest, WhatMeansTheSameIsTheSameText) {
  const std::string all = canonical(R"({"camera": "front"})");
  EXPECT_EQ(canonical(R"({"formats": ["png"], "camera": "front", "height": 360, "width": 640.0})"), all);
  EXPECT_EQ(canonical(R"({"camera": "front", "frames": [0,1,2,3,4,5,6,7,8,9], "tone_map": "filmic"})"), all);
  EXPECT_EQ(canonical(R"({"camera": "front", "formats": ["jpg", "exr"]})"),
            canonical(R"({"camera": "front", "formats": ["exr", "jpg"]})"));
  EXPECT_EQ(canonical(all), all);
  for (const char* other :
       {R"({"camera": "front", "width": 641})", R"({"camera": "front", "exposure_stops": 0})",
        R"({"camera": "front", "frames": [0]})", R"({"camera": "front", "tone_map": "clip"})",
        R"({"camera": "front", "samples_per_pixel": 5})",
        R"({"camera": {"position": [1, 2, 3], "target": [0, 0, 0]}})"})
    EXPECT_NE(canonical(other), all) << other;
}

TEST(ViewRequest, EveryPlaceThatIsWrongIsNamed) {
  EXPECT_EQ(refused(R"({"camera": "back", "frames": [3, 3, 10, -1], "width": 0, "formats": [], "x": 1})"),
            (std::vector<std::string>{"/camera unknown_camera", "/formats wrong_length",
                                      "/frames/1 not_increasing", "/frames/2 out_of_range",
                                      "/frames/3 out_of_range", "/width out_of_range", "/x unknown_field"}));
  EXPECT_EQ(refused("{}"), (std::vector<std::string>{"/camera missing"}));
  EXPECT_FALSE(refused("").empty());
  EXPECT_FALSE(refused("[1]").empty());
}

TEST(ViewRequest, AllFramesTogetherHaveALimit) {
  EXPECT_EQ(refused(R"({"camera": "front", "width": 8192, "height": 8192})"), std::vector<std::string>{});
  api::ViewedJob longer = job();
  longer.frame_count = 100;
  EXPECT_FALSE(api::parse_view_request(R"({"camera": "front", "width": 8192, "height": 8192})", longer));
}

}  // namespace
