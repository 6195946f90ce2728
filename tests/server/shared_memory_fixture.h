// A server that shares memory, and a client of it that may do as it likes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "client/library/chunk_supply.h"
#include "core/base/posix/packet_socket.h"
#include "proto/wire/side_messages.h"
#include "server/shared_memory/side_connection.h"
#include "server/streams/mesh_engine.h"
#include "tests/server/passing_time.h"
#include "tests/server/plain_channel.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"

namespace tet::test {

/// Blocks of a ring: twice one for each of two threads and one more, and another.
inline constexpr std::uint64_t kRingBlocks = 7;

class SharedMemoryTest : public ServiceTest {
 protected:
  SharedMemoryTest() { config_.listen_unix = socket_; }

  /// The server gives no memory up because a test takes its time.
  void start() {
    ServiceTest::start();
    const_cast<MeshEngine&>(engine()).kept_memory.keep_for(std::chrono::hours(1));
  }

  std::unique_ptr<MeshClient> local() const { return MeshClient::connect("unix:" + socket_); }

  StreamedMesh received(MeshClient& client, const v1::MeshRequest& request) const {
    auto mesh = client.stream_mesh(request, {}, never_);
    EXPECT_TRUE(mesh.ok()) << mesh.status();
    return mesh.ok() ? *std::move(mesh) : StreamedMesh{};
  }

  /// Takes a mesh chunk by chunk; returns how many tets they had, and 0 after a failure.
  std::uint64_t tets_by_chunks(MeshClient& client, const v1::MeshRequest& request) const {
    const auto supply = client.stream_chunks(request, {}, never_);
    for (std::uint64_t tets = 0;;) {
      const auto chunk = supply->next();
      EXPECT_TRUE(chunk.ok()) << chunk.status();
      if (!chunk.ok()) return 0;
      if (*chunk == nullptr) return tets;
      tets += (*chunk)->place.tet_count;
    }
  }

  /// Why a call is ended that `attempt` makes, and for which it then lets time pass. What gRPC
  /// has not yet said is written has waited as long, and is given up without any details: then
  /// nothing was tried, and another attempt is made.
  std::string reason_when_stalled(const std::function<grpc::Status()>& attempt) const {
    grpc::Status status;
    eventually([&] {
      status = attempt();
      return status.ok() || HasFailure() || !status.error_details().empty();
    });
    return reason_of(status);
  }

  std::int64_t shared_streams() const { return activity().shared_streams.load(); }
  const MeshEngine& engine() const { return server_->engine(); }
  std::uint64_t kept_bytes() const { return engine().kept_memory.bytes(); }

  const std::string socket_ = folder_.file("socket");
};

/// A client that may do as it likes.
class WilfulClient {
 public:
  explicit WilfulClient(const std::string& socket)
      : WilfulClient(socket, connect_for_packets(socket + kSideSocketEnding)) {}
  WilfulClient(const std::string& socket, Descriptor side)
      : side_(std::move(side)),
        meshes_(v1::MeshService::NewStub(plain_channel("unix:" + socket))) {
    Descriptor none;
    EXPECT_TRUE(
        await_packet(side_, std::as_writable_bytes(std::span(token_)), kGenerousEnd, none));
  }

  const std::string& token() const { return token_; }
  const Descriptor& side() const { return side_; }
  void close_side() { side_ = Descriptor(); }

  /// Begins a stream, as far as its header; once the one before it has finished.
  void begin(v1::StreamMeshRequest request, const std::string& token) {
    request.set_shared_memory(token);
    reader_.reset();
    context_ = std::make_unique<grpc::ClientContext>();
    reader_ = meshes_->StreamMesh(context_.get(), request);
    while (reader_->Read(&event_) && !event_.has_header()) {
    }
  }
  bool has_ring() const { return header().has_shared_memory(); }
  /// Until something else is read.
  const v1::MeshHeader& header() const { return event_.header(); }

  Descriptor take_memory() const {
    SideMessage size{};
    Descriptor memory;
    EXPECT_TRUE(await_packet(side_, size, kGenerousEnd, memory));
    return memory;
  }

  /// Reads on to the next chunk; false after the last.
  bool read_chunk() {
    while (reader_->Read(&event_)) {
      if (event_.has_chunk()) return true;
    }
    return false;
  }
  const v1::MeshChunk& chunk() const { return event_.chunk(); }
  /// Reads on to the trailer; false where the stream ends before.
  bool read_trailer() {
    while (reader_->Read(&event_)) {
      if (event_.has_trailer()) return true;
    }
    return false;
  }
  bool say(std::uint64_t index) const { return send_packet(side_, side_message(index)); }

  /// Acknowledges all that comes from chunk `index` on, as far as the end.
  grpc::Status follow(std::uint64_t index = 0) {
    while (read_chunk()) say(index++);
    return finish();
  }
  grpc::Status finish() {
    while (reader_->Read(&event_)) {
    }
    return reader_->Finish();
  }

 private:
  Descriptor side_;
  std::string token_ = std::string(SideConnection::kTokenBytes, '\0');
  std::unique_ptr<v1::MeshService::Stub> meshes_;
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReader<v1::MeshEvent>> reader_;
  v1::MeshEvent event_;
};

}  // namespace tet::test
