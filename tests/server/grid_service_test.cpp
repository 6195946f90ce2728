#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/wire/sha256.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

std::string name_of(std::string_view text) {
  Sha256 digest;
  digest.add(text);
  return name_of_grid(digest.finish_hex());
}

class GridServiceTest : public ServiceTest {
 protected:
  GridServiceTest() { start(); }

  struct Outcome {
    grpc::Status status;
    v1::UploadGridResponse response;
  };

  /// Announces `name`, sends `text` from `offset` on in one message, and ends the stream.
  Outcome upload(const std::string& name,
                 const std::string& text,
                 std::size_t size,
                 std::int64_t offset = 0) {
    Outcome outcome;
    grpc::ClientContext context;
    const auto writer = grids_->UploadGrid(&context, &outcome.response);
    v1::UploadGridRequest message;
    message.mutable_start()->set_name(name);
    message.mutable_start()->set_size_bytes(static_cast<std::int64_t>(size));
    writer->Write(message);
    message.mutable_data()->set_offset(offset);
    message.mutable_data()->set_data(text);
    writer->Write(message);
    writer->WritesDone();
    outcome.status = writer->Finish();
    return outcome;
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
  ASSERT_TRUE(upload(name_of("abc"), "abc", 3).response.complete());
  grpc::ClientContext context;
  v1::FindMissingGridsRequest request;
  request.add_names(name_of("abc"));
  request.add_names(name_of("xyz"));
  v1::FindMissingGridsResponse response;
  ASSERT_TRUE(grids_->FindMissingGrids(&context, request, &response).ok());
  EXPECT_THAT(response.missing_names(), testing::ElementsAre(name_of("xyz")));
}

TEST_F(GridServiceTest, EndsAnUploadOfAStoredFileWithoutItsData) {
  ASSERT_TRUE(upload(name_of("abc"), "abc", 3).response.complete());
  grpc::ClientContext context;
  v1::UploadGridResponse response;
  const auto writer = grids_->UploadGrid(&context, &response);
  v1::UploadGridRequest message;
  message.mutable_start()->set_name(name_of("abc"));
  message.mutable_start()->set_size_bytes(3);
  writer->Write(message);
  EXPECT_TRUE(writer->Finish().ok());  // and WritesDone was never called
  EXPECT_TRUE(response.complete());
  EXPECT_EQ(response.committed_size(), 3);
}

TEST_F(GridServiceTest, ResumesACutUploadFromItsCommittedSize) {
  {
    grpc::ClientContext context;
    v1::UploadGridResponse response;
    const auto writer = grids_->UploadGrid(&context, &response);
    v1::UploadGridRequest message;
    message.mutable_start()->set_name(name_of("abcdef"));
    message.mutable_start()->set_size_bytes(6);
    writer->Write(message);
    message.mutable_data()->set_data("abc");
    writer->Write(message);
    ASSERT_TRUE(eventually([&] { return committed(name_of("abcdef")) == 3; }));
    context.TryCancel();
    EXPECT_FALSE(writer->Finish().ok());
  }
  ASSERT_TRUE(eventually([&] { return server_->running_calls() == 0; }));
  restart();
  EXPECT_EQ(committed(name_of("abcdef")), 3);
  const Outcome rest = upload(name_of("abcdef"), "def", 6, 3);
  EXPECT_TRUE(rest.status.ok()) << rest.status.error_message();
  EXPECT_TRUE(rest.response.complete());
}

TEST_F(GridServiceTest, KeepsAnUploadThatEndedEarly) {
  const Outcome outcome = upload(name_of("abcdef"), "abc", 6);
  EXPECT_TRUE(outcome.status.ok());
  EXPECT_FALSE(outcome.response.complete());
  EXPECT_EQ(outcome.response.committed_size(), 3);
}

TEST_F(GridServiceTest, RefusesBytesOfAnotherDigest) {
  const Outcome outcome = upload(name_of("abc"), "xyz", 3);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(reason_of(outcome.status), "tetstream/WRONG_DIGEST");
  EXPECT_EQ(committed(name_of("abc")), 0);
}

TEST_F(GridServiceTest, SaysWhatIsWrongWithAnUpload) {
  EXPECT_EQ(reason_of(upload("grids/abc", "abc", 3).status), "tetstream/INVALID_FIELD");
  EXPECT_EQ(reason_of(upload(name_of("abc"), "abc", 0).status), "tetstream/INVALID_FIELD");
  EXPECT_EQ(reason_of(upload(name_of("abc"), "abc", 3, 1).status), "tetstream/WRONG_OFFSET");
  EXPECT_EQ(reason_of(upload(name_of("abc"), "abcd", 3).status), "tetstream/TOO_MUCH_DATA");
  EXPECT_EQ(reason_of(upload(name_of("abc"), "abc", std::size_t{1} << 60).status),
            "tetstream/LIMIT_EXCEEDED");
}

TEST_F(GridServiceTest, ListsByPages) {
  for (const char* text : {"a", "b", "c"}) upload(name_of(text), text, 1);
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

TEST_F(GridServiceTest, RefusesToDescribeWhatIsNotAVdb) {
  upload(name_of("abc"), "abc", 3);
  const auto info = client_->grid_info(name_of("abc"), never_);
  EXPECT_EQ(info.status().code(), absl::StatusCode::kInvalidArgument) << info.status();
}

}  // namespace
}  // namespace tet::test
