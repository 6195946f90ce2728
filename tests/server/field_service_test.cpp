// Values of other grids at the vertices of a mesh that a server sends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/remesh_session.h"
#include "core/plan/make/mesher.h"
#include "core/vdb/openvdb/load.h"
#include "proto/scene/scene_message.h"
#include "tests/server/column_text.h"
#include "tests/server/service_fixture.h"
#include "tests/server/streamed_chunks.h"

namespace tet::test {
namespace {

/// What this process reads of a grid.
VertexField read_field(const std::string& path,
                       const std::string& grid,
                       const std::string& name) {
  VertexField field{name, "", grid, {}};
  std::uint32_t count = 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    Volume volume = load_field(path, grid, i).value();
    count = components_of(volume.kind);
    field.components.push_back(std::make_shared<const Volume>(std::move(volume)));
  }
  return field;
}

/// The first field is what the fixture's is.
void expect_heat(const TetMesh& mesh) {
  const auto* value = reinterpret_cast<const float*>(mesh.fields.bytes().data());
  ASSERT_GT(mesh.header.vertex_count, 0U);
  for (std::uint64_t i = 0; i < mesh.header.vertex_count; ++i) {
    const WorldPoint p = mesh.vertex(i);
    ASSERT_NEAR(*value, 1 + 2 * p.x - 3 * p.y + p.z / 2, 2e-6);
    value += mesh.header.field_values();
  }
}

class FieldServiceTest : public ServiceTest {
 protected:
  FieldServiceTest() {
    start();
    path_ = solid_file("fields", 0.1);
    mesh_ = mesh_of(path_);
    mesh_.set_grid_name("sphere");
    add("heat", "");
    add("velocity", "flow");
  }

  v1::Field& add(const std::string& grid, const std::string& name) {
    v1::Field& field = *mesh_.add_fields();
    field.set_grid_name(grid);
    field.set_name(name);
    return field;
  }

  absl::StatusOr<StreamedMesh> received(v1::Encoding encoding = v1::ENCODING_PLAIN) {
    return client_->stream_mesh(mesh_, {}, never_, {.encoding = encoding, .used = {}});
  }

  std::vector<std::string> chunks(std::int64_t start = 0) {
    return streamed_chunks(*meshes_, stream_of(mesh_, start));
  }

  std::string path_;
  v1::MeshRequest mesh_;
};

TEST_F(FieldServiceTest, SendsTheValuesThatThisProcessFinds) {
  mesh_.set_preset(v1::PRESET_BOTH_SIDES);
  MeshRequest request;
  request.levels = default_levels(Sizing());
  request.preset = Preset::kBothSides;
  request.fields = {read_field(path_, "heat", ""), read_field(path_, "velocity", "flow")};
  TaskPool pool(2);
  const auto here = mesh_volume(
      pool, {.shape = std::make_shared<const Volume>(load_volume(path_, "sphere").value()),
             .request = request});
  const auto there = received();
  ASSERT_TRUE(here.ok() && there.ok()) << there.status();
  const std::vector<FieldArray> arrays{{"heat", 1}, {"flow", 3}};
  EXPECT_EQ(there->mesh.header.fields, arrays);
  EXPECT_EQ(text_of(there->mesh.positions), text_of(here->mesh.positions));
  EXPECT_EQ(text_of(there->mesh.tets), text_of(here->mesh.tets));
  EXPECT_EQ(text_of(there->mesh.regions), text_of(here->mesh.regions));
  EXPECT_EQ(text_of(there->mesh.fields), text_of(here->mesh.fields));
}

TEST_F(FieldServiceTest, FillsInWhatTheRequestLeavesOut) {
  const auto header = client_->estimate(mesh_, never_);
  ASSERT_TRUE(header.ok()) << header.status();
  const auto& fields = header->canonical_request().fields();
  ASSERT_EQ(fields.size(), 2);
  EXPECT_EQ(fields[0].name(), "heat");
  EXPECT_EQ(fields[0].grid(), mesh_.name());
  EXPECT_EQ(fields[1].name(), "flow");
  EXPECT_EQ(fields[1].grid_name(), "velocity");
  EXPECT_EQ(header->mesh_bytes(), 28 * header->vertex_count() + 16 * header->tet_count());
  const std::string id = header->mesh_id();
  mesh_.mutable_fields(0)->set_name("heat");
  mesh_.mutable_fields(1)->set_grid(mesh_.name());
  EXPECT_EQ(client_->estimate(mesh_, never_)->mesh_id(), id) << "their defaults";
  mesh_.mutable_fields()->SwapElements(0, 1);
  EXPECT_NE(client_->estimate(mesh_, never_)->mesh_id(), id);
}

TEST_F(FieldServiceTest, SendsTheSameChunksFromWhereAStreamIsResumed) {
  mesh_.set_spacing(0.03);
  const auto whole = chunks(), rest = chunks(1);
  ASSERT_GT(whole.size(), 2U);
  EXPECT_EQ(std::vector(whole.begin() + 1, whole.end()), rest);
}

TEST_F(FieldServiceTest, TakesAnotherFileAlsoForAScene) {
  const std::string name = mesh_.name();
  mesh_.clear_fields();
  mesh_.clear_name();
  mesh_.clear_grid_name();
  mesh_.set_spacing(0.1);
  mesh_.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
  add("heat", "").set_grid(name);
  const auto of_scene = received();
  ASSERT_TRUE(of_scene.ok()) << of_scene.status();
  expect_heat(of_scene->mesh);
}

TEST_F(FieldServiceTest, SendsAMeshWholeToWhoeverHasABase) {
  const auto first = received();
  ASSERT_TRUE(first.ok()) << first.status();
  const auto again = client_->update_mesh(mesh_, *first, {}, never_);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(text_of(first->mesh.fields), text_of(again->mesh.fields));
  EXPECT_EQ(first->mesh_id, again->mesh_id);
}

/// A cut adds an array to those of the fields, of which there may be as many without it.
TEST_F(FieldServiceTest, SendsTheFacesOfACutBesideAllFieldsThatAMeshMayHave) {
  mesh_.clear_fields();
  for (std::size_t i = 0; i < VertexField::kMaxFields; ++i) {
    add("heat", "heat " + std::to_string(i));
  }
  set_point(-2, *mesh_.mutable_box()->mutable_min());
  set_point(0.5, *mesh_.mutable_box()->mutable_max());
  for (const v1::Encoding encoding : {v1::ENCODING_PLAIN, v1::ENCODING_PACKED}) {
    const auto there = received(encoding);
    ASSERT_TRUE(there.ok()) << there.status();
    const std::vector<FieldArray>& arrays = there->mesh.header.fields;
    ASSERT_EQ(arrays.size(), VertexField::kMaxFields + 1);
    EXPECT_EQ(arrays.back().name, kCutFaceArray);
    expect_heat(there->mesh);
  }
}

TEST_F(FieldServiceTest, FollowsAShapeThroughASession) {
  const auto session = client_->begin_session(mesh_, never_);
  ASSERT_TRUE(session.ok()) << session.status();
  expect_heat((*session)->mesh().mesh);
  v1::LeafUpdate leaf;
  leaf.set_x(8);
  const float outside = 0.3F;
  leaf.set_values(&outside, sizeof(outside));
  ASSERT_EQ((*session)->update(std::vector{leaf}), absl::OkStatus());
  EXPECT_EQ((*session)->mesh().mesh.header.fields.size(), 2U);
  expect_heat((*session)->mesh().mesh);
  EXPECT_EQ((*session)->end(), absl::OkStatus());
}

TEST_F(FieldServiceTest, KeepsVolumesOfFieldsApartFromThoseThatAreMeshed) {
  add("sphere", "distance");
  const auto with = received();
  ASSERT_TRUE(with.ok()) << with.status();
  mesh_.set_grid_name("heat");
  mesh_.set_iso(1);
  mesh_.set_inside(v1::INSIDE_BELOW);
  mesh_.set_preset(v1::PRESET_BOTH_SIDES);
  EXPECT_TRUE(received().ok()) << "a field, too";
}

}  // namespace
}  // namespace tet::test
