#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "core/plan/mesh_plan.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/wire/checksum.h"
#include "tests/server/held_place.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

/// Everything one stream said.
struct Received {
  grpc::Status status;
  v1::MeshHeader header;
  std::vector<v1::MeshChunk> chunks;
  std::optional<v1::MeshTrailer> trailer;
};

bool same_chunk(const v1::MeshChunk& a, const v1::MeshChunk& b) {
  return a.SerializeAsString() == b.SerializeAsString();
}

class MeshServiceTest : public ServiceTest {
 protected:
  MeshServiceTest() { start(); }

  /// Reads a stream to its end, or cancels it after `max_chunks`.
  Received receive(const v1::StreamMeshRequest& request, std::size_t max_chunks = ~0U) {
    Received received;
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, request);
    for (v1::MeshEvent event; reader->Read(&event);) {
      if (event.has_header()) received.header = event.header();
      if (event.has_chunk()) received.chunks.push_back(event.chunk());
      if (event.has_trailer()) received.trailer = event.trailer();
      if (received.chunks.size() >= max_chunks) context.TryCancel();
    }
    received.status = reader->Finish();
    return received;
  }

  grpc::StatusCode refusal(const v1::StreamMeshRequest& request) {
    return receive(request).status.error_code();
  }
};

TEST_F(MeshServiceTest, SendsHeaderChunksAndTrailer) {
  const Received mesh = receive(stream_of(uniform_ball(16)));
  ASSERT_TRUE(mesh.status.ok()) << mesh.status.error_message();
  ASSERT_GT(mesh.chunks.size(), 2U);
  std::int64_t tets = 0;
  std::int64_t vertices = 0;
  for (const v1::MeshChunk& chunk : mesh.chunks) {
    EXPECT_EQ(chunk.first_tet(), tets);
    EXPECT_EQ(chunk.first_vertex(), vertices);
    EXPECT_EQ(chunk.checksum(), chunk_checksum({chunk.positions(), chunk.tets(),
                                                chunk.regions(), chunk.fields()}));
    EXPECT_LE(chunk.positions().size() + chunk.tets().size() + chunk.regions().size(),
              kChunkBytes);
    tets += chunk.tet_count();
    vertices += chunk.vertex_count();
  }
  EXPECT_EQ(tets, mesh.header.tet_count());
  EXPECT_EQ(vertices, mesh.header.vertex_count());
  EXPECT_EQ(static_cast<std::int64_t>(mesh.chunks.size()), mesh.header.chunk_count());
  ASSERT_TRUE(mesh.trailer);
  EXPECT_EQ(mesh.trailer->end_chunk(), mesh.header.chunk_count());
  EXPECT_GE(mesh.trailer->quality().min_dihedral_deg(), 11.3);
  EXPECT_LE(mesh.trailer->quality().max_dihedral_deg(), 154.7);
  EXPECT_NEAR(mesh.trailer->quality().volume(), 4.18879, 0.03);
}

TEST_F(MeshServiceTest, GivesTheSameBytesWhereverAStreamIsCutAndResumed) {
  const v1::MeshRequest ball = uniform_ball(16);
  const Received whole = receive(stream_of(ball));
  ASSERT_GT(whole.chunks.size(), 2U);
  for (std::size_t cut = 1; cut <= whole.chunks.size(); ++cut) {
    Received part = receive(stream_of(ball), cut);
    ASSERT_GE(part.chunks.size(), cut);
    part.chunks.resize(cut);
    v1::StreamMeshRequest rest = stream_of(ball, static_cast<std::int64_t>(cut));
    rest.set_expected_mesh_id(part.header.mesh_id());
    const Received resumed = receive(rest);
    ASSERT_TRUE(resumed.status.ok()) << resumed.status.error_message();
    part.chunks.insert(part.chunks.end(), resumed.chunks.begin(), resumed.chunks.end());
    ASSERT_EQ(part.chunks.size(), whole.chunks.size());
    for (std::size_t i = 0; i < whole.chunks.size(); ++i) {
      EXPECT_TRUE(same_chunk(part.chunks[i], whole.chunks[i]))
          << "cut " << cut << " chunk " << i;
    }
    ASSERT_TRUE(resumed.trailer);
    EXPECT_EQ(resumed.trailer->first_chunk(), static_cast<std::int64_t>(cut));
  }
}

TEST_F(MeshServiceTest, SendsTheChunksOfARangeAndNoTrailer) {
  const v1::MeshRequest ball = uniform_ball(16);
  const Received whole = receive(stream_of(ball));
  const Received range = receive(stream_of(ball, 1, 2));
  ASSERT_TRUE(range.status.ok());
  ASSERT_EQ(range.chunks.size(), 1U);
  EXPECT_TRUE(same_chunk(range.chunks[0], whole.chunks[1]));
  EXPECT_FALSE(range.trailer);
}

TEST_F(MeshServiceTest, SendsARegionForEveryTetWhereBothSidesAreMeshed) {
  const Received mesh = receive(stream_of(both_sides_of_ball(16, 2)));
  ASSERT_TRUE(mesh.status.ok()) << mesh.status.error_message();
  EXPECT_TRUE(mesh.header.has_regions());
  ASSERT_GT(mesh.chunks.size(), 1U);
  std::int64_t inside = 0;
  for (const v1::MeshChunk& chunk : mesh.chunks) {
    EXPECT_EQ(static_cast<std::int64_t>(chunk.regions().size()), chunk.tet_count());
    EXPECT_LE(chunk.positions().size() + chunk.tets().size() + chunk.regions().size(),
              kChunkBytes);
    inside += std::count(chunk.regions().begin(), chunk.regions().end(), '\1');
  }
  EXPECT_GT(inside, 0);
  EXPECT_LT(inside, mesh.header.tet_count());
  EXPECT_NEAR(mesh.trailer->quality().volume(), 64, 1e-3) << "the whole box";
  EXPECT_EQ(mesh.header.canonical_request().box().max().y(), 2);
}

TEST_F(MeshServiceTest, SendsTheBoundaryOfTheWholeMeshWhateverChunksItSent) {
  const v1::MeshRequest ball = uniform_ball(16);
  const Received whole = receive(stream_of(ball)), rest = receive(stream_of(ball, 1));
  ASSERT_TRUE(whole.trailer && rest.trailer);
  EXPECT_EQ(whole.trailer->boundary().components(), 1);
  EXPECT_EQ(whole.trailer->boundary().euler_characteristic(), 2);
  EXPECT_EQ(whole.trailer->boundary().SerializeAsString(),
            rest.trailer->boundary().SerializeAsString());
}

TEST_F(MeshServiceTest, SendsTheSameMeshWithoutStatisticsAndDoesNotMissThemAfterwards) {
  v1::MeshRequest ball = uniform_ball(16);
  ball.set_skip_statistics(true);
  const Received only = receive(stream_of(ball));
  ASSERT_TRUE(only.trailer) << only.status.error_message();
  EXPECT_FALSE(only.trailer->has_quality());
  EXPECT_FALSE(only.trailer->has_boundary());
  ball.clear_skip_statistics();
  const Received whole = receive(stream_of(ball));
  ASSERT_TRUE(whole.trailer) << whole.status.error_message();
  EXPECT_TRUE(whole.trailer->has_quality());
  EXPECT_EQ(whole.trailer->boundary().components(), 1);
  EXPECT_EQ(only.header.mesh_id(), whole.header.mesh_id());
  ASSERT_EQ(only.chunks.size(), whole.chunks.size());
  for (std::size_t i = 0; i < whole.chunks.size(); ++i) {
    EXPECT_TRUE(same_chunk(only.chunks[i], whole.chunks[i])) << "chunk " << i;
  }
}

TEST_F(MeshServiceTest, SendsNoBoundaryWhereTheBoxCutsTheSurface) {
  const Received within = receive(stream_of(both_sides_of_ball(8, 2)));
  ASSERT_TRUE(within.trailer);
  EXPECT_TRUE(within.trailer->has_boundary());
  const Received cut = receive(stream_of(both_sides_of_ball(8, 0.7)));
  ASSERT_TRUE(cut.trailer);
  EXPECT_FALSE(cut.trailer->has_boundary());
}

TEST_F(MeshServiceTest, EstimatesTheHeaderItWouldSend) {
  const v1::MeshRequest ball = uniform_ball(8);
  auto estimate = client_->estimate(ball, never_);
  ASSERT_TRUE(estimate.ok()) << estimate.status();
  EXPECT_GT(estimate->fill_seconds(), 0);
  estimate->clear_fill_seconds();
  EXPECT_EQ(estimate->SerializeAsString(), receive(stream_of(ball)).header.SerializeAsString());
  EXPECT_EQ(estimate->canonical_request().spacing(), 0.125);
}

TEST_F(MeshServiceTest, EstimatesAnImprovedMeshByTheNameOfItsStream) {
  v1::MeshRequest ball = uniform_ball(8);
  const auto plain = client_->estimate(ball, never_);
  ball.set_improve(true);
  auto improved = client_->estimate(ball, never_);
  ASSERT_TRUE(plain.ok() && improved.ok());
  EXPECT_NE(plain->mesh_id(), improved->mesh_id());
  improved->clear_fill_seconds();
  EXPECT_EQ(improved->SerializeAsString(), receive(stream_of(ball)).header.SerializeAsString());
}

TEST_F(MeshServiceTest, ResumesAnImprovedMesh) {
  v1::MeshRequest ball = uniform_ball(16);
  const Received plain = receive(stream_of(ball));
  ball.set_improve(true);
  const Received whole = receive(stream_of(ball));
  ASSERT_TRUE(whole.trailer);
  EXPECT_FALSE(plain.trailer->has_improvement());
  EXPECT_GT(whole.trailer->improvement().moved_vertices(), 0);
  EXPECT_GE(whole.trailer->quality().min_dihedral_deg(), 20);
  restart();
  const Received rest = receive(stream_of(ball, 1));
  ASSERT_TRUE(rest.trailer);
  EXPECT_EQ(rest.header.mesh_id(), whole.header.mesh_id());
  EXPECT_EQ(rest.trailer->improvement().moved_vertices(),
            whole.trailer->improvement().moved_vertices());
  ASSERT_EQ(rest.chunks.size() + 1, whole.chunks.size());
  for (std::size_t i = 0; i < rest.chunks.size(); ++i) {
    EXPECT_TRUE(same_chunk(rest.chunks[i], whole.chunks[i + 1])) << "chunk " << i + 1;
  }
}

TEST_F(MeshServiceTest, TellsItsLimits) {
  const auto capabilities = client_->capabilities(never_);
  ASSERT_TRUE(capabilities.ok());
  EXPECT_EQ(capabilities->presets_size(), 3);
  EXPECT_EQ(capabilities->max_chunk_bytes(), std::int64_t{kChunkBytes});
  EXPECT_EQ(capabilities->limits().max_store_bytes(),
            static_cast<std::int64_t>(config_.store_bytes));
  EXPECT_EQ(capabilities->limits().max_client_meshes(),
            static_cast<std::int32_t>(config_.max_client_streams));
  EXPECT_EQ(capabilities->limits().stall_seconds(),
            static_cast<std::int32_t>(config_.stall_seconds));
}

TEST_F(MeshServiceTest, RefusesWhatItCannotMesh) {
  v1::MeshRequest ball = uniform_ball(8);
  EXPECT_EQ(refusal(stream_of(ball, 1000)), grpc::StatusCode::OUT_OF_RANGE);
  v1::StreamMeshRequest other = stream_of(ball);
  other.set_expected_mesh_id("another");
  EXPECT_EQ(refusal(other), grpc::StatusCode::FAILED_PRECONDITION);
  ball.set_spacing(-1);
  EXPECT_EQ(refusal(stream_of(ball)), grpc::StatusCode::INVALID_ARGUMENT);
  ball.clear_spacing();
  ball.set_iso(100);
  EXPECT_EQ(refusal(stream_of(ball)), grpc::StatusCode::FAILED_PRECONDITION);
  ball.clear_iso();
  v1::MeshRequest boxed = both_sides_of_ball(8, 1e9);
  EXPECT_EQ(refusal(stream_of(boxed)), grpc::StatusCode::INVALID_ARGUMENT);
  boxed = both_sides_of_ball(8, -1);
  EXPECT_EQ(refusal(stream_of(boxed)), grpc::StatusCode::INVALID_ARGUMENT);
  v1::StreamMeshRequest improved = stream_of(ball);
  improved.mutable_mesh()->set_improve(true);
  improved.set_encoding(v1::ENCODING_COMPACT);
  EXPECT_EQ(refusal(improved), grpc::StatusCode::INVALID_ARGUMENT);
  v1::StreamMeshRequest graded = stream_of(ball);
  graded.mutable_mesh()->mutable_sizing()->set_coarsest(4);
  graded.mutable_mesh()->mutable_sizing()->set_grade_surface(true);
  graded.set_encoding(v1::ENCODING_COMPACT);
  EXPECT_EQ(refusal(graded), grpc::StatusCode::INVALID_ARGUMENT);
  ball.set_grid_name("nothing");
  EXPECT_EQ(refusal(stream_of(ball)), grpc::StatusCode::NOT_FOUND);
  ball.set_name("grids/" + std::string(64, '0'));
  EXPECT_EQ(refusal(stream_of(ball)), grpc::StatusCode::NOT_FOUND);
}

TEST_F(MeshServiceTest, RefusesBytesThatAreNoRequest) {
  grpc::GenericStub stub(channel_);
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  void* tag = nullptr;
  bool ok = false;
  const auto wait = [&] { return queue.Next(&tag, &ok) && ok; };
  const auto call = stub.PrepareCall(&context, "/tetstream.v1.MeshService/StreamMesh", &queue);
  call->StartCall(nullptr);
  wait();
  const grpc::Slice garbage("\x0a\xff\xff");  // a field that is longer than the message
  call->WriteLast(grpc::ByteBuffer(&garbage, 1), {}, nullptr);
  wait();
  grpc::Status status;
  call->Finish(&status, nullptr);
  wait();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_TRUE(work_stops());
}

TEST_F(MeshServiceTest, UsesTheBlocksOfOneStreamAgainForTheNext) {
  const v1::StreamMeshRequest ball = stream_of(uniform_ball(28));
  const auto blocks_of_a_stream = [&] {
    const Received mesh = receive(ball);
    EXPECT_GT(mesh.chunks.size(), 30U);
    return server_->engine().blocks.idle();
  };
  EXPECT_TRUE(eventually([&] { return blocks_of_a_stream() > 0; }));
  EXPECT_LE(blocks_of_a_stream(), 8U) << "more than made ahead and in the transport's hands";
}

TEST_F(MeshServiceTest, RefusesAMeshOverItsLimitWithDetails) {
  config_.max_tets = 1000;
  restart();
  const Received refused = receive(stream_of(uniform_ball(8)));
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.status.error_message(), testing::HasSubstr("the limit is"));
  google::rpc::Status rpc;
  google::rpc::ErrorInfo info;
  ASSERT_TRUE(rpc.ParseFromString(refused.status.error_details()));
  ASSERT_TRUE(rpc.details(0).UnpackTo(&info));
  EXPECT_EQ(info.domain(), "tetstream");
}

TEST_F(MeshServiceTest, ASlowReaderHoldsAFewChunksAndSlowsNobodyElse) {
  const v1::MeshRequest ball = uniform_ball(28);
  grpc::ClientContext context;
  const auto slow = meshes_->StreamMesh(&context, stream_of(ball));
  v1::MeshEvent event;
  while (slow->Read(&event) && !event.has_chunk()) {
  }
  const auto fast = client_->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(fast.ok()) << fast.status();
  const auto total = static_cast<std::int64_t>(fast->mesh.header.chunk_count);
  const auto only_slow_is_left = [&] {
    return activity().meshes == 1 && activity().chunks_in_flight == 0;
  };
  EXPECT_TRUE(eventually(only_slow_is_left));
  EXPECT_LT(activity().chunks_made - total, total);
  context.TryCancel();
  slow->Finish();
  EXPECT_TRUE(work_stops());
}

TEST_F(MeshServiceTest, StopsWorkingForAClientThatLeft) {
  const v1::MeshRequest ball = uniform_ball(28);
  const Received part = receive(stream_of(ball), 1);
  EXPECT_EQ(part.status.error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(work_stops());
  EXPECT_LT(activity().chunks_made, part.header.chunk_count());
}

TEST_F(MeshServiceTest, StopsWorkingAtTheDeadline) {
  const v1::StreamMeshRequest request = stream_of(uniform_ball(28));
  bool began = false;
  // A busy machine may need longer for the first event; then it gets twice the time.
  for (auto time = 600ms; !began && time < kGenerousEnd; time *= 2) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + time);
    const auto reader = meshes_->StreamMesh(&context, request);
    v1::MeshEvent event;
    began = reader->Read(&event);
    std::this_thread::sleep_until(context.deadline());
    while (reader->Read(&event)) {
    }
    EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    EXPECT_TRUE(work_stops());
  }
  EXPECT_TRUE(began);
}

TEST_F(MeshServiceTest, TellsOneStreamTooManyToRetry) {
  config_.max_streams = 1;
  config_.max_queued = 0;
  restart();
  const v1::MeshRequest ball = uniform_ball(28);
  HeldPlace first(*server_);
  const Received second = receive(stream_of(ball));
  EXPECT_EQ(second.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  google::rpc::Status rpc;
  ASSERT_TRUE(rpc.ParseFromString(second.status.error_details()));
  google::rpc::RetryInfo retry;
  EXPECT_TRUE(std::any_of(rpc.details().begin(), rpc.details().end(),
                          [&](const auto& detail) { return detail.UnpackTo(&retry); }));
  EXPECT_EQ(retry.retry_delay().seconds(), 1);
  first.let_go();
  ASSERT_TRUE(work_stops());
  EXPECT_TRUE(receive(stream_of(ball, 0, 1)).status.ok());
}

TEST_F(MeshServiceTest, DrainsARunningStreamAndRefusesNewOnes) {
  const v1::MeshRequest ball = uniform_ball(28);
  const auto impatient = MeshClient::connect(server_->address(), RetryPolicy{.attempts = 1});
  grpc::ClientContext context;
  const auto reader = meshes_->StreamMesh(&context, stream_of(ball));
  v1::MeshEvent event;
  ASSERT_TRUE(reader->Read(&event));
  std::thread stopper([&] { server_->stop(kGenerousEnd); });
  EXPECT_TRUE(eventually([&] { return !impatient->check_health("readiness", never_).ok(); }));
  EXPECT_TRUE(impatient->check_health("liveness", never_).ok());
  EXPECT_EQ(refusal(stream_of(ball)), grpc::StatusCode::UNAVAILABLE);
  bool whole = false;
  while (reader->Read(&event)) whole |= event.has_trailer();
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_TRUE(whole);
  stopper.join();
}

TEST_F(MeshServiceTest, CancelsAStreamThatOutlivesTheDrain) {
  const v1::MeshRequest ball = uniform_ball(28);
  grpc::ClientContext context;
  const auto reader = meshes_->StreamMesh(&context, stream_of(ball));
  v1::MeshEvent event;
  ASSERT_TRUE(reader->Read(&event));
  server_->stop(0s);
  EXPECT_EQ(activity().meshes, 0);
  EXPECT_EQ(activity().chunks_in_flight, 0);
  while (reader->Read(&event)) {
  }
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
}

}  // namespace
}  // namespace tet::test
