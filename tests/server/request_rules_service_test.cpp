// Every pair of features that a request can have, asked of a server: it is refused as the table
// of rules says, or it makes a mesh.
#include <fstream>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/remesh_session.h"
#include "proto/convert/request_rules.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"
#include "tests/support/feature_requests.h"

namespace tet::test {
namespace {

/// What came of one stream.
struct Streamed {
  grpc::Status status;
  std::optional<v1::MeshHeader> header;
  std::int64_t chunks = 0;
  bool has_trailer = false;
};

class RequestRulesTest : public ServiceTest {
 protected:
  RequestRulesTest() {
    start();
    file_ = mesh_of(solid_file("parts", 0.1)).name();
    labels_ = mesh_of(labels_file()).name();
  }

  Streamed stream(const v1::StreamMeshRequest& request) {
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, request);
    Streamed streamed;
    for (v1::MeshEvent event; reader->Read(&event);) {
      if (event.has_header()) streamed.header = event.header();
      streamed.chunks += event.has_chunk() ? 1 : 0;
      streamed.has_trailer |= event.has_trailer();
    }
    streamed.status = reader->Finish();
    return streamed;
  }

  void expect_refused(const v1::StreamMeshRequest& request, const RequestRule& rule) {
    const Streamed streamed = stream(request);
    EXPECT_EQ(streamed.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(streamed.status.error_message(), message_of(rule, names_in(request.mesh())));
    EXPECT_EQ(reason_of(streamed.status), "tetstream/INVALID_FIELD");
    EXPECT_FALSE(field_of(streamed.status).empty());
  }

  void expect_mesh(const v1::StreamMeshRequest& request) {
    const Streamed streamed = stream(request);
    ASSERT_TRUE(streamed.status.ok()) << streamed.status.error_message();
    ASSERT_TRUE(streamed.header);
    EXPECT_GT(streamed.header->tet_count(), 0);
    const bool whole =
        request.end_chunk() == 0 || request.end_chunk() == streamed.header->chunk_count();
    EXPECT_EQ(streamed.chunks, whole ? streamed.header->chunk_count() : request.end_chunk());
    EXPECT_EQ(streamed.has_trailer, whole);
  }

  /// Everything is kept of a mesh that has not changed, unless the rules say that it is sent
  /// whole.
  void expect_update(v1::StreamMeshRequest request, bool is_sent_whole) {
    v1::StreamMeshRequest first = request;
    first.clear_base_name();
    first.clear_base_mesh_id();
    first.clear_end_chunk();
    const Streamed before = stream(first);
    ASSERT_TRUE(before.status.ok()) << before.status.error_message();
    request.set_base_mesh_id(before.header->mesh_id());
    request.clear_end_chunk();
    const Streamed after = stream(request);
    ASSERT_TRUE(after.status.ok()) << after.status.error_message();
    ASSERT_TRUE(after.header);
    EXPECT_EQ(after.header->mesh_id(), before.header->mesh_id());
    EXPECT_EQ(after.header->has_kept(), !is_sent_whole);
    EXPECT_EQ(after.chunks, is_sent_whole ? before.chunks : 0);
    EXPECT_TRUE(after.has_trailer);
  }

  void expect_session(const v1::MeshRequest& request, const RequestRule* rule) {
    const auto session = client_->begin_session(request, never_);
    if (rule != nullptr && rule->outcome == Outcome::kRefused) {
      EXPECT_EQ(session.status().message(), message_of(*rule, names_in(request)));
      return;
    }
    ASSERT_TRUE(session.ok()) << session.status();
    const std::uint64_t all = (*session)->mesh().mesh.header.tet_count;
    EXPECT_GT(all, 0U);
    ASSERT_EQ((*session)->update(std::vector<v1::LeafUpdate>()), absl::OkStatus());
    EXPECT_EQ((*session)->tets_sent(), rule == nullptr ? 0 : all);
  }

  void expect_samples(const v1::MeshRequest& request, const RequestRule* rule) {
    const std::vector<WorldPoint> points{{0, 0, 0}};
    const auto samples = client_->sample_points(request, points, {}, never_);
    if (rule != nullptr) {
      EXPECT_EQ(samples.status().message(), message_of(*rule, names_in(request)));
      return;
    }
    ASSERT_TRUE(samples.ok()) << samples.status();
    EXPECT_EQ(samples->phi.size(), 1U);
  }

  /// A cube of label 1, in an image of 12 voxels along each axis.
  std::string labels_file() {
    const std::string path = folder_.file("labels.nrrd");
    std::ofstream file(path, std::ios::binary);
    file << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 12 12 12\nencoding: raw\n\n";
    const auto within = [](int v) { return v >= 3 && v < 9; };
    for (int i = 0; i < 12 * 12 * 12; ++i) {
      const bool is_one = within(i % 12) && within(i / 12 % 12) && within(i / 144);
      file.put(is_one ? '\1' : '\0');
    }
    return path;
  }

  std::string file_, labels_;
};

TEST_F(RequestRulesTest, EveryPairIsRefusedAsTheTableSaysOrMakesAMesh) {
  const FeatureRequest requests(file_, labels_);
  for (const Feature a : all_features()) {
    for (const Feature b : all_features()) {
      if (a >= b || !can_be_asked_together(a, b) || b == Feature::kJob) continue;
      SCOPED_TRACE(field_names().of(a) + " beside " + field_names().of(b));
      const v1::StreamMeshRequest request = requests.with(a, b);
      const RequestRule* const rule = find_rule(a, b);
      if (b == Feature::kSession) {
        expect_session(request.mesh(), rule);
      } else if (b == Feature::kPoints) {
        expect_samples(request.mesh(), rule);
      } else if (rule != nullptr && rule->outcome == Outcome::kRefused) {
        expect_refused(request, *rule);
      } else if (a == Feature::kEarlierMesh || b == Feature::kEarlierMesh) {
        expect_update(request, rule != nullptr);
      } else {
        expect_mesh(request);
      }
    }
  }
}

}  // namespace
}  // namespace tet::test
