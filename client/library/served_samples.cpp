#include "client/library/served_samples.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <absl/strings/str_cat.h>

#include "client/library/raw_call.h"
#include "client/library/stream_checks.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/point_samples.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

namespace {

/// Far below any server's limit on a message.
constexpr std::size_t kPointsPerBatch = 16384;

/// Answers to points, from as many calls as it takes. Trusts nothing that the server says.
class SampleReader {
 public:
  SampleReader(std::span<const WorldPoint> points, int fields)
      : points_(points), fields_(fields) {}

  std::size_t answered() const noexcept { return answered_; }
  bool complete() const noexcept { return has_header_ && answered_ == points_.size(); }
  PointSamples& samples() noexcept { return samples_; }

  /// Another call begins, at the first point without an answer.
  void begin_call() noexcept {
    call_has_header_ = false;
    begin_ = sent_ = answered_;
  }

  /// The next points to be sent. At most two messages are not answered: the server reads one
  /// ahead, so writing and reading in turn never wait for each other.
  std::span<const WorldPoint> next_batch() noexcept {
    if (sent_ - answered_ > kPointsPerBatch) return {};
    const std::size_t count = std::min(kPointsPerBatch, points_.size() - sent_);
    const auto batch = points_.subspan(sent_, count);
    sent_ += count;
    return batch;
  }

  absl::Status take(grpc::ByteBuffer& bytes) {
    v1::SamplePointsResponse message;
    if (!deserialize(bytes, message)) {
      return bad_stream("a message that is no SamplePointsResponse");
    }
    if (message.has_header()) return take_header(message.header());
    return message.has_samples() ? take_samples(message.samples()) : absl::OkStatus();
  }

 private:
  absl::Status take_header(const v1::SampleHeader& header) {
    auto arrays = from_proto(header.fields());
    if (!arrays.ok()) return bad_stream(std::string(arrays.status().message()));
    if (header.fields_size() != fields_ || (has_header_ && *arrays != samples_.arrays)) {
      return bad_stream("its fields are not those that were asked for");
    }
    call_has_header_ = true;
    if (std::exchange(has_header_, true)) return absl::OkStatus();
    samples_.inside_guess = header.inside_guess();
    for (const FieldArray& array : *arrays) samples_.width += array.components;
    samples_.arrays = *std::move(arrays);
    samples_.resize(points_.size());
    return absl::OkStatus();
  }

  absl::Status take_samples(const v1::PointSamples& message) {
    const std::int64_t expected = static_cast<std::int64_t>(answered_ - begin_);
    const std::int64_t most = static_cast<std::int64_t>(sent_ - answered_);
    if (!call_has_header_ || message.first_point() != expected || message.point_count() < 1 ||
        message.point_count() > most) {
      return bad_stream(absl::StrCat("samples of ", message.point_count(), " points from ",
                                     message.first_point(), " on, where ", expected,
                                     " is the next"));
    }
    const auto count = static_cast<std::size_t>(message.point_count());
    const absl::Status copied =
        copy_samples(message, samples_.columns().part(answered_, count, samples_.width));
    if (!copied.ok()) return bad_stream(std::string(copied.message()));
    answered_ += count;
    return absl::OkStatus();
  }

  const std::span<const WorldPoint> points_;
  const int fields_;  ///< that were asked for
  PointSamples samples_;
  bool has_header_ = false, call_has_header_ = false;
  std::size_t begin_ = 0, sent_ = 0, answered_ = 0;
};

/// False when the server takes no more.
bool write_points(RawCall& call, SampleReader& reader) {
  for (auto batch = reader.next_batch(); !batch.empty(); batch = reader.next_batch()) {
    v1::SamplePointsRequest message;
    to_proto(batch, *message.mutable_points());
    if (!call.write(serialized(message))) return false;
  }
  return true;
}

/// Sends and reads all that is left. Errors: kDataLoss; where the call broke its end tells why.
absl::Status exchange(RawCall& call,
                      const v1::MeshRequest& request,
                      SampleReader& reader,
                      const std::function<void()>& tell) {
  v1::SamplePointsRequest start;
  *start.mutable_start() = request;
  if (!call.write(serialized(start))) return absl::OkStatus();
  reader.begin_call();
  while (!reader.complete()) {
    grpc::ByteBuffer answer;
    if (!write_points(call, reader) || !call.read(answer)) return absl::OkStatus();
    if (auto status = reader.take(answer); !status.ok()) return status;
    tell();
  }
  call.writes_done();
  return absl::OkStatus();
}

/// One call. OK where all points are answered.
absl::Status sample_once(const ServerChannel& server,
                         const v1::MeshRequest& request,
                         SampleReader& reader,
                         const std::function<void()>& tell,
                         const Cancellation& cancellation) {
  ClientCall attempt(server, cancellation);
  RawCall call(server.channel(), attempt.context(), v1::MeshService::service_full_name(),
               "SamplePoints");
  const absl::Status exchanged = exchange(call, request, reader, tell);
  // What the server says of a call that we give up is that it was given up.
  if (!exchanged.ok()) attempt.context().TryCancel();
  const absl::Status ended = attempt.result(call.finish());
  if (!exchanged.ok()) return exchanged;
  if (reader.complete()) return absl::OkStatus();
  return ended.ok() ? absl::UnavailableError("the server ended the call") : ended;
}

}  // namespace

absl::StatusOr<PointSamples> sample_there(Connection& connection,
                                          const v1::MeshRequest& request,
                                          std::span<const WorldPoint> points,
                                          const PointProgress& progress,
                                          const Cancellation& cancellation) {
  if (auto status = check_points(points); !status.ok()) return status;
  SampleReader reader(points, request.fields_size());
  const auto tell = [&] {
    if (progress) progress(reader.answered(), points.size());
  };
  for (Retries retries = connection.begin(cancellation);;) {
    const ServerChannel& asked = connection.server();
    const absl::Status status = sample_once(asked, request, reader, tell, cancellation);
    if (status.ok() || reader.answered() > 0) connection.answered();
    if (status.ok()) return std::move(reader.samples());
    if (auto ended = connection.again(retries, asked, status, reader.answered()); !ended.ok())
      return ended;
  }
}

}  // namespace tet
