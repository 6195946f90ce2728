// JobClient: a result that is nowhere whole.
#include <algorithm>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "client/library/connection.h"
#include "client/library/job_client.h"
#include "client/library/receive_mesh.h"
#include "client/library/stream_checks.h"
#include "client/library/thrown_status.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/jobs.grpc.pb.h"

namespace tet {

namespace {

/// What the threads of one mesh share. The first failure stops all of them at their next chunk.
class Parts {
 public:
  Parts(const MeshHeader& header, const PartSink& sink, const ClientProgress& progress)
      : header_(header), sink_(sink), progress_(progress) {}

  absl::Status put(const TetMesh& part, const ChunkExtent& place) {
    const std::lock_guard lock(mutex_);
    if (!failure_.ok()) return absl::CancelledError("another part of the mesh failed");
    if (absl::Status status = sink_(part, place); !status.ok()) return status;
    tets_ += place.tet_count;
    if (progress_.tets) progress_.tets(tets_, header_.tet_count);
    return absl::OkStatus();
  }

  void ended(const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    if (failure_.ok()) failure_ = status;
  }

  const absl::Status& failure() const { return failure_; }  ///< once the threads have ended

 private:
  const MeshHeader& header_;
  const PartSink& sink_;
  const ClientProgress& progress_;
  std::mutex mutex_;
  absl::Status failure_;
  std::uint64_t tets_ = 0;
};

/// One receiver for each of up to `streams` ranges of about as many chunks.
std::vector<PartReceiver> divide(const MeshHeader& header,
                                 const std::string& mesh_id,
                                 int streams,
                                 Parts& parts) {
  const std::uint64_t count = header.chunk_count;
  const std::uint64_t ranges = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(streams), 1,
                                                         std::max(count, std::uint64_t{1}));
  std::vector<PartReceiver> receivers;
  for (std::uint64_t i = 0; i < ranges; ++i) {
    receivers.emplace_back(header, mesh_id, count * i / ranges, count * (i + 1) / ranges,
                           [&parts](const TetMesh& part, const ChunkExtent& place) {
                             return parts.put(part, place);
                           });
  }
  return receivers;
}

/// One range. What is thrown out of its thread would end the process, and leave behind all that
/// was begun.
absl::Status receive(Connection& connection,
                     const std::string& job,
                     PartReceiver& receiver,
                     const Cancellation& cancellation) try {
  const auto request = [&] {
    v1::ReadJobResultRequest rest;
    rest.set_name(job);
    rest.set_start_chunk(static_cast<std::int64_t>(receiver.next_chunk()));
    rest.set_end_chunk(static_cast<std::int64_t>(receiver.end_chunk()));
    return serialized(rest);
  };
  return receive_stream(
      connection,
      {v1::JobService::service_full_name(), "ReadJobResult", request,
       [&](grpc::ByteBuffer& event) { return receiver.take(event); },
       [&] { return receiver.complete(); }, [&] { return receiver.next_chunk(); }},
      cancellation);
} catch (...) {
  return status_of_exception();
}

/// Whether the ranges lie one after the other and are all of the mesh.
absl::Status check_whole(const std::vector<PartReceiver>& receivers, const MeshHeader& header) {
  std::uint64_t vertices = 0, tets = 0, faces = 0;
  for (const PartReceiver& receiver : receivers) {
    const ChunkExtent& covered = receiver.covered();
    if (covered.first_vertex != vertices || covered.first_tet != tets ||
        covered.first_face != faces) {
      return bad_stream("its chunks leave gaps");
    }
    vertices += covered.vertex_count;
    tets += covered.tet_count;
    faces += covered.face_count;
  }
  if (vertices == header.vertex_count && tets == header.tet_count &&
      faces == header.face_count) {
    return absl::OkStatus();
  }
  return bad_stream("its chunks are not all of the mesh");
}

}  // namespace

absl::Status JobClient::read_parts(const v1::Job& job,
                                   int streams,
                                   const PartSink& sink,
                                   const ClientProgress& progress,
                                   const Cancellation& cancellation) {
  const auto header = checked_header(job.header());
  if (!header.ok()) return header.status();
  Parts parts(*header, sink, progress);
  std::vector<PartReceiver> receivers = divide(*header, job.header().mesh_id(), streams, parts);
  {
    std::vector<std::jthread> threads;
    threads.reserve(receivers.size());
    for (PartReceiver& receiver : receivers) {
      const auto work = [&] {
        parts.ended(receive(*connection_, job.name(), receiver, cancellation));
      };
      try {
        threads.emplace_back(work);
      } catch (...) {  // no more threads: those that run are to stop
        parts.ended(status_of_exception());
      }
    }
  }
  if (!parts.failure().ok()) return parts.failure();
  return check_whole(receivers, *header);
}

}  // namespace tet
