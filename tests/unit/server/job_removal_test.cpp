// What goes when a job goes, and what a start finds that was cut short.
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::Fault;

using JobRemovalTest = ServiceTest;

TEST_F(JobRemovalTest, OnlyAFinishedJobIsRemovedAndWithAllItsFiles) {
  const Job submitted = submit();
  EXPECT_EQ(jobs_->remove(submitted.id).error().fault, Fault::wrong_state);
  ASSERT_TRUE(jobs_->cancel(submitted.id));
  ASSERT_TRUE(jobs_->remove(submitted.id));
  EXPECT_FALSE(std::filesystem::exists(folder_->job(submitted.id)));
  EXPECT_EQ(jobs_->job(submitted.id).error().fault, Fault::not_found);
  EXPECT_EQ(jobs_->remove(submitted.id).error().fault, Fault::not_found);
  EXPECT_TRUE(store_->all_ids()->empty());
}

TEST_F(JobRemovalTest, ARemovalCutShortIsEndedAtTheNextStart) {
  const Job submitted = submit();
  ASSERT_TRUE(jobs_->cancel(submitted.id));
  ASSERT_TRUE(store_->begin_removal(submitted.id));  // and now kill -9
  restart();
  EXPECT_EQ(jobs_->job(submitted.id).error().fault, Fault::not_found) << "nobody sees it any more";
  EXPECT_TRUE(std::filesystem::exists(folder_->job(submitted.id)));
  ASSERT_TRUE(jobs_->clean_up());
  EXPECT_FALSE(std::filesystem::exists(folder_->job(submitted.id)));
  EXPECT_TRUE(store_->all_ids()->empty());
}

TEST_F(JobRemovalTest, ARemovalThatFailedHalfwayGoesOnWhenItIsAskedForAgain) {
  const Job submitted = submit();
  ASSERT_TRUE(jobs_->cancel(submitted.id));
  ASSERT_TRUE(store_->begin_removal(submitted.id));  // and the files could not be removed
  ASSERT_TRUE(jobs_->remove(submitted.id));
  EXPECT_FALSE(std::filesystem::exists(folder_->job(submitted.id)));
  EXPECT_TRUE(store_->all_ids()->empty());
}

TEST_F(JobRemovalTest, FilesOfASubmissionCutShortAreRemovedAtTheNextStart) {
  const Upload upload = make_upload();
  ASSERT_TRUE(move_folder(folder_->upload(upload.id), folder_->job(upload.id)));  // and now kill -9
  const Upload another = make_upload();
  const std::string kept = submit().id;
  restart();
  ASSERT_TRUE(jobs_->clean_up());
  EXPECT_FALSE(std::filesystem::exists(folder_->job(upload.id)));
  EXPECT_FALSE(std::filesystem::exists(folder_->upload(another.id)));
  EXPECT_TRUE(std::filesystem::exists(folder_->job(kept)));
}

}  // namespace
}  // namespace server
