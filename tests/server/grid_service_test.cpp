#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/open_upload.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

class GridServiceTest : public ServiceTest {
 protected:
  GridServiceTest() { start(); }

  UploadOutcome upload(const std::string& name,
                       const std::string& text,
                       std::size_t size,
                       std::int64_t offset = 0) {
    return upload_text(*grids_, name, text, size, offset);
  }

  std::int64_t committed(const std::string& name) {
    grpc::ClientContext context;
    v1::GetUploadStatusRequest request;
    request.set_name(name);
    v1::UploadStatus status;
    EXPECT_TRUE(grids_->GetUploadStatus(&context, request, &status).ok());
    return status.committed_size();
  }

  v1::ListGridsResponse list(int page_size, const std::string& token) {
    grpc::ClientContext context;
    v1::ListGridsRequest request;
    request.set_page_size(page_size);
    request.set_page_token(token);
    v1::ListGridsResponse response;
    EXPECT_TRUE(grids_->ListGrids(&context, request, &response).ok());
    return response;
  }
};

TEST_F(GridServiceTest, FindsOnlyWhatIsMissing) {
  ASSERT_TRUE(upload(grid_name_of("abc"), "abc", 3).response.complete());
  grpc::ClientContext context;
  v1::FindMissingGridsRequest request;
  request.add_names(grid_name_of("abc"));
  request.add_names(grid_name_of("xyz"));
  v1::FindMissingGridsResponse response;
  ASSERT_TRUE(grids_->FindMissingGrids(&context, request, &response).ok());
  EXPECT_THAT(response.missing_names(), testing::ElementsAre(grid_name_of("xyz")));
}

TEST_F(GridServiceTest, EndsAnUploadOfAStoredFileWithoutItsData) {
  ASSERT_TRUE(upload(grid_name_of("abc"), "abc", 3).response.complete());
  OpenUpload again(*grids_, grid_name_of("abc"), 3);
  EXPECT_TRUE(again.wait().ok());
  EXPECT_TRUE(again.response().complete());
  EXPECT_EQ(again.response().committed_size(), 3);
}

TEST_F(GridServiceTest, ResumesACutUploadFromItsCommittedSize) {
  {
    OpenUpload cut(*grids_, grid_name_of("abcdef"), 6);
    cut.send("abc");
    ASSERT_TRUE(eventually([&] { return committed(grid_name_of("abcdef")) == 3; }));
    EXPECT_FALSE(cut.cancel().ok());
  }
  ASSERT_TRUE(eventually([&] { return server_->running_calls() == 0; }));
  restart();
  EXPECT_EQ(committed(grid_name_of("abcdef")), 3);
  const UploadOutcome rest = upload(grid_name_of("abcdef"), "def", 6, 3);
  EXPECT_TRUE(rest.status.ok()) << rest.status.error_message();
  EXPECT_TRUE(rest.response.complete());
}

TEST_F(GridServiceTest, KeepsAnUploadThatEndedEarly) {
  const UploadOutcome outcome = upload(grid_name_of("abcdef"), "abc", 6);
  EXPECT_TRUE(outcome.status.ok());
  EXPECT_FALSE(outcome.response.complete());
  EXPECT_EQ(outcome.response.committed_size(), 3);
}

TEST_F(GridServiceTest, RefusesBytesOfAnotherDigest) {
  const UploadOutcome outcome = upload(grid_name_of("abc"), "xyz", 3);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(reason_of(outcome.status), "tetstream/WRONG_DIGEST");
  EXPECT_EQ(committed(grid_name_of("abc")), 0);
}

TEST_F(GridServiceTest, SaysWhatIsWrongWithAnUpload) {
  EXPECT_EQ(reason_of(upload("grids/abc", "abc", 3).status), "tetstream/INVALID_FIELD");
  EXPECT_EQ(reason_of(upload(grid_name_of("abc"), "abc", 0).status), "tetstream/INVALID_FIELD");
  EXPECT_EQ(reason_of(upload(grid_name_of("abc"), "abc", 3, 1).status),
            "tetstream/WRONG_OFFSET");
  EXPECT_EQ(reason_of(upload(grid_name_of("abc"), "abcd", 3).status),
            "tetstream/TOO_MUCH_DATA");
  EXPECT_EQ(reason_of(upload(grid_name_of("abc"), "abc", std::size_t{1} << 60).status),
            "tetstream/LIMIT_EXCEEDED");
}

TEST_F(GridServiceTest, ListsByPages) {
  for (const char* text : {"a", "b", "c"}) upload(grid_name_of(text), text, 1);
  const auto first = list(2, "");
  ASSERT_EQ(first.files_size(), 2);
  const auto second = list(2, first.next_page_token());
  ASSERT_EQ(second.files_size(), 1);
  EXPECT_TRUE(second.next_page_token().empty());
  EXPECT_LT(first.files(1).name(), second.files(0).name());
}

TEST_F(GridServiceTest, TellsWhatAFileHolds) {
  const auto request = uniform_ball(8);
  const auto info = client_->grid_info(request.name(), never_);
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_EQ(info->grids_size(), 1);
  EXPECT_EQ(info->grids(0).value_type(), "float");
  EXPECT_DOUBLE_EQ(info->grids(0).voxel_size(), 0.125);
  EXPECT_GT(info->grids(0).active_voxel_count(), 0U);
}

TEST_F(GridServiceTest, TellsOnRequestWhatValuesSayOfAFile) {
  const auto request = uniform_ball(8);
  const auto plain = client_->grid_info(request.name(), never_);
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_FALSE(plain->grids(0).has_values());
  const auto info = client_->grid_info(request.name(), never_, GridDetail::kValues);
  ASSERT_TRUE(info.ok()) << info.status();
  const v1::GridInfo& grid = info->grids(0);
  EXPECT_LT(grid.values().min(), 0);
  EXPECT_GT(grid.values().max(), 0);
  EXPECT_EQ(grid.values().inside(), "below");
  EXPECT_EQ(grid.values().inside_source(), v1::INSIDE_SOURCE_CLASS);
  EXPECT_EQ(grid.label_count(), 0);
}

TEST_F(GridServiceTest, TellsTheLabelsOfASegmentation) {
  const auto uploaded = client_->upload_file(WHOLE_NUMBERS_PATH "/int32.vdb", {}, never_);
  ASSERT_TRUE(uploaded.ok()) << uploaded.status();
  const auto info = client_->grid_info(*uploaded, never_, GridDetail::kValues);
  ASSERT_TRUE(info.ok()) << info.status();
  const v1::GridInfo& grid = info->grids(0);
  ASSERT_EQ(grid.label_count(), grid.labels_size());
  ASSERT_GT(grid.labels_size(), 1);
  std::uint64_t voxels = 0;
  for (int i = 0; i < grid.labels_size(); ++i) {
    const v1::GridLabel& label = grid.labels(i);
    EXPECT_TRUE(i == 0 || grid.labels(i - 1).value() < label.value());
    EXPECT_LE(label.box().min_x(), label.box().max_x());
    voxels += label.voxel_count();
  }
  const v1::VoxelBox& box = grid.active_box();
  EXPECT_EQ(voxels, static_cast<std::uint64_t>((box.max_x() - box.min_x() + 1) *
                                               (box.max_y() - box.min_y() + 1) *
                                               (box.max_z() - box.min_z() + 1)));
}

/// Files that are in the store before the server starts, of zeros that take no disk.
class LargeFilesTest : public ServiceTest {
 protected:
  static constexpr std::uint64_t kLarge = std::uint64_t{1} << 40;  // many minutes of digesting

  LargeFilesTest() { config_.store_bytes = config_.max_client_upload_bytes = 16 * kLarge; }

  void store(const std::string& path, std::uint64_t size) {
    const std::filesystem::path file = std::filesystem::path(config_.store) / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file).flush();
    std::filesystem::resize_file(file, size);
  }
};

TEST_F(LargeFilesTest, KeepNoDecoderFromOthersWhileTheyAreFoundToBeNone) {
  const std::string digest = "aa" + std::string(62, '0');
  store("grids/aa/" + digest, kLarge);
  config_.decoders = 1;
  start();
  grpc::ClientContext context;
  v1::GetGridInfoRequest about;
  about.set_name(name_of_grid(digest));
  v1::GridFile told;
  std::promise<grpc::Status> asked;
  grids_->async()->GetGridInfo(&context, &about, &told, [&](grpc::Status status) {
    asked.set_value(std::move(status));
  });
  ASSERT_TRUE(eventually([&] { return server_->running_calls() == 1; }));
  auto answer = asked.get_future();
  const auto info = client_->grid_info(uniform_ball(8).name(), never_);
  EXPECT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(answer.wait_for(0s), std::future_status::timeout) << "it was waited for";
  context.TryCancel();
  EXPECT_EQ(answer.get().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(eventually([&] { return server_->running_calls() == 0; }));
}

TEST_F(LargeFilesTest, HoldUpNobodyWhileTheirUploadsAreResumed) {
  const std::string first(64, 'a'), second(64, 'b');  // one for each of the disk's threads
  for (const std::string& digest : {first, second}) {
    store("uploads/" + digest + ".part", kLarge);
  }
  start();
  OpenUpload one(*grids_, name_of_grid(first), kLarge + 1);
  OpenUpload two(*grids_, name_of_grid(second), kLarge + 1);
  ASSERT_TRUE(eventually([&] { return server_->running_calls() == 2; }));
  ASSERT_TRUE(client_->list_grids(never_).ok());
  EXPECT_GE(server_->running_calls(), 2) << "they were waited for";
  EXPECT_FALSE(one.cancel().ok());
  EXPECT_FALSE(two.cancel().ok());
  EXPECT_TRUE(eventually([&] { return server_->running_calls() == 0; }));
}

TEST_F(GridServiceTest, RefusesToDescribeWhatIsNotAVdb) {
  upload(grid_name_of("abc"), "abc", 3);
  const auto info = client_->grid_info(grid_name_of("abc"), never_);
  EXPECT_EQ(info.status().code(), absl::StatusCode::kInvalidArgument) << info.status();
}

}  // namespace
}  // namespace tet::test
