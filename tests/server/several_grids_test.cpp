// The meshes of several grids of one file, from a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/remesh_session.h"
#include "core/plan/make/mesher.h"
#include "core/vdb/openvdb/load.h"
#include "tests/server/column_text.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"
#include "tests/server/streamed_chunks.h"

namespace tet::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class SeveralGridsTest : public ServiceTest {
 protected:
  SeveralGridsTest() {
    start();
    path_ = solid_file("parts", 0.1);
    mesh_ = mesh_of(path_);
    name({"ball", "ring", "cloud"});
  }

  void name(const std::vector<std::string>& grids) {
    mesh_.mutable_grid_names()->Assign(grids.begin(), grids.end());
  }

  absl::StatusOr<StreamedMesh> received(v1::Encoding encoding = v1::ENCODING_PLAIN) {
    return client_->stream_mesh(mesh_, {}, never_, {.encoding = encoding, .used = {}});
  }

  /// What this process makes of the same grids.
  absl::StatusOr<MeshResult> made_here(MeshRequest request = {}) {
    request.levels = default_levels(Sizing());
    GridList grids;
    for (const std::string& grid : mesh_.grid_names()) {
      grids.push_back(std::make_shared<const Volume>(load_volume(path_, grid).value()));
    }
    TaskPool pool(2);
    return mesh_volume(pool, {.shape = grids, .request = request});
  }

  std::vector<std::string> chunks(std::int64_t start = 0) {
    return streamed_chunks(*meshes_, stream_of(mesh_, start));
  }

  grpc::Status refusal() {
    grpc::ClientContext context;
    v1::EstimateMeshRequest request;
    *request.mutable_mesh() = mesh_;
    v1::MeshHeader header;
    return meshes_->EstimateMesh(&context, request, &header);
  }

  void expect_refused(const std::string& reason,
                      const std::string& field,
                      const std::string& words) {
    const grpc::Status status = refusal();
    EXPECT_EQ(reason_of(status), "tetstream/" + reason) << status.error_message();
    EXPECT_EQ(field_of(status), field);
    EXPECT_THAT(status.error_message(), HasSubstr(words));
  }

  std::string path_;
  v1::MeshRequest mesh_;
};

TEST_F(SeveralGridsTest, SendsTheBytesThatThisProcessMakes) {
  MeshRequest request;
  for (const bool improve : {false, true}) {
    mesh_.set_improve(improve);
    request.improve = improve;
    const auto here = made_here(request);
    const auto there = received();
    ASSERT_TRUE(here.ok() && there.ok()) << here.status() << there.status();
    EXPECT_EQ(there->mesh.header.parts, here->mesh.header.parts);
    EXPECT_EQ(there->mesh.header.origin, here->mesh.header.origin);
    EXPECT_EQ(text_of(there->mesh.positions), text_of(here->mesh.positions));
    EXPECT_EQ(text_of(there->mesh.tets), text_of(here->mesh.tets));
    EXPECT_EQ(there->boundary, here->boundary);
    EXPECT_EQ(there->improvement.has_value(), improve);
  }
}

TEST_F(SeveralGridsTest, SendsTheValuesOfFieldsForAllOfThem) {
  v1::Field& field = *mesh_.add_fields();
  field.set_grid_name("velocity");
  const auto there = received();
  ASSERT_TRUE(there.ok()) << there.status();
  const auto* value = reinterpret_cast<const float*>(there->mesh.fields.bytes().data());
  const MeshHeader& header = there->mesh.header;
  for (std::uint64_t i = 0; i < header.parts[0].vertex_count; ++i, value += 3) {
    const WorldPoint p = there->mesh.vertex(i);
    ASSERT_NEAR(value[1], 2 * p.z, 1e-5);
  }
}

TEST_F(SeveralGridsTest, SaysWhichTetsAreWhose) {
  const auto header = client_->estimate(mesh_, never_);
  ASSERT_TRUE(header.ok()) << header.status();
  std::int64_t vertices = 0, tets = 0;
  std::vector<std::string> names;
  for (const v1::MeshPart& part : header->parts()) {
    names.push_back(part.name());
    v1::MeshRequest alone = mesh_;
    alone.clear_grid_names();
    alone.set_grid_name(part.name());
    const auto one = client_->estimate(alone, never_);
    ASSERT_TRUE(one.ok()) << one.status();
    EXPECT_TRUE(one->parts().empty());
    EXPECT_EQ(part.first_vertex(), vertices);
    EXPECT_EQ(part.first_tet(), tets);
    EXPECT_EQ(part.vertex_count(), one->vertex_count());
    EXPECT_EQ(part.tet_count(), one->tet_count());
    EXPECT_EQ(part.spacing(), one->spacing());
    vertices += one->vertex_count();
    tets += one->tet_count();
  }
  EXPECT_THAT(names, ElementsAre("ball", "ring", "cloud"));
  EXPECT_EQ(header->vertex_count(), vertices);
  EXPECT_EQ(header->tet_count(), tets);
}

TEST_F(SeveralGridsTest, HaveAnIdOfTheirNamesInTheirOrder) {
  const auto first = client_->estimate(mesh_, never_);
  ASSERT_TRUE(first.ok()) << first.status();
  const v1::MeshRequest& canonical = first->canonical_request();
  EXPECT_THAT(canonical.grid_names(), ElementsAre("ball", "ring", "cloud"));
  EXPECT_FALSE(canonical.has_spacing() || canonical.has_iso()) << "each has its own";
  const v1::MeshRequest asked = mesh_;
  mesh_ = canonical;
  EXPECT_EQ(client_->estimate(mesh_, never_)->mesh_id(), first->mesh_id());
  mesh_ = asked;
  name({"ring", "ball", "cloud"});
  EXPECT_NE(client_->estimate(mesh_, never_)->mesh_id(), first->mesh_id());
  mesh_ = asked;
  mesh_.set_iso(0);
  EXPECT_NE(client_->estimate(mesh_, never_)->mesh_id(), first->mesh_id());
}

TEST_F(SeveralGridsTest, AreTheSameChunksFromWhereAStreamIsResumed) {
  mesh_.set_spacing(0.04);
  const auto whole = chunks(), rest = chunks(2);
  ASSERT_GT(whole.size(), 4U);
  EXPECT_EQ(std::vector(whole.begin() + 2, whole.end()), rest);
}

TEST_F(SeveralGridsTest, AreThoseThatTheFileHasForMeshing) {
  const auto grids = client_->meshable_grids(mesh_.name(), never_);
  ASSERT_TRUE(grids.ok()) << grids.status();
  EXPECT_THAT(*grids, ElementsAre("ball", "ring", "cloud", "twin"));
}

TEST_F(SeveralGridsTest, AreRefusedWithTheirPlaceAmongThem) {
  name({"ball", "bell", "ring"});
  expect_refused("GRID_NOT_IN_FILE", "mesh.grid_names[1]", "there is no grid 'bell'");
  EXPECT_THAT(refusal().error_message(), AllOf(HasSubstr("'ball'"), HasSubstr("'twin'")));
  name({"ball", "ring", "velocity"});
  expect_refused("NOT_MESHABLE", "mesh.grid_names[2]", "vec3s");
  name({"ball", "ring", "ball"});
  expect_refused("INVALID_FIELD", "mesh.grid_names[2]", "'ball' is grid_names[0], too");
  name({"ball", ""});
  expect_refused("INVALID_FIELD", "mesh.grid_names[1]", "is empty");
  name({std::string(1025, 'x')});
  expect_refused("INVALID_FIELD", "mesh.grid_names[0]", "has 1025 bytes; the limit is 1024");
  std::vector<std::string> many;
  for (int i = 0; i < 65; ++i) many.push_back(std::to_string(i));
  name(many);
  expect_refused("INVALID_FIELD", "mesh.grid_names", "has 65 entries; it takes 1 to 64");
}

TEST_F(SeveralGridsTest, AreRefusedWithWhatIsForOneGrid) {
  mesh_.set_grid_name("ball");
  expect_refused("INVALID_FIELD", "mesh.grid_name", "beside grid_names");
  mesh_.clear_grid_name();
  mesh_.set_preset(v1::PRESET_BOTH_SIDES);
  expect_refused("INVALID_FIELD", "mesh.grid_names", "would overlap");
  mesh_.clear_preset();
  const std::string stored = mesh_.name();
  mesh_.clear_name();
  mesh_.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
  expect_refused("INVALID_FIELD", "mesh.grid_names", "a scene has no grids");
  mesh_.clear_scene();
  mesh_.set_name(stored);
  EXPECT_THAT(std::string(received(v1::ENCODING_COMPACT).status().message()),
              HasSubstr("ENCODING_COMPACT is for one grid"));
  const auto whole = received();
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_THAT(std::string(client_->update_mesh(mesh_, *whole, {}, never_).status().message()),
              HasSubstr("base_name is for one grid"));
  const auto session = client_->begin_session(mesh_, never_);
  EXPECT_THAT(std::string(session.status().message()), HasSubstr("a session follows one grid"));
}

TEST_F(SeveralGridsTest, NameTheOneThatHasNothingInside) {
  name({"ball", "ring"});
  mesh_.set_iso(-0.6);  // beyond what the level sets hold
  expect_refused("NOTHING_TO_MESH", "", "nothing is inside at iso -0.6");
  EXPECT_THAT(refusal().error_message(), HasSubstr("(grid 'ball')"));
}

}  // namespace
}  // namespace tet::test
