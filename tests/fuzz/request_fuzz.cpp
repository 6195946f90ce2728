// What clients send, as bytes: refused with a reason, or an order that keeps its promises.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <google/protobuf/stubs/logging.h>
#include <grpcpp/support/byte_buffer.h>

#include "core/scene/scene.h"
#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "proto/convert/upload_piece.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::request_fuzz {
namespace {

/// A status on the wire takes no more than this.
constexpr std::size_t kMaxDetails = 1024;

void check_refusal(const absl::Status& status) {
  require(absl::IsInvalidArgument(status));
  require(to_grpc(status).error_details().size() <= kMaxDetails);
}

void check_stream_request(const std::string& bytes) {
  v1::StreamMeshRequest message;
  if (!message.ParseFromString(bytes)) return;
  const auto order = parse_stream_request(message);
  if (!order.ok()) return check_refusal(order.status());
  const MeshRequest& request = order->mesh.request;
  const Scene* scene = order->mesh.made_scene.get();
  require(order->mesh.digest.size() == (order->mesh.is_scene() ? 0 : 64));
  require((scene == nullptr) == (!order->mesh.is_scene() || order->mesh.scene.has_grids()));
  require(scene == nullptr || request.box || scene->ends());
  require(!request.spacing || (std::isfinite(*request.spacing) && *request.spacing > 0));
  require(!request.iso || std::isfinite(*request.iso));
  require(request.levels >= 0);
  require(request.fields.size() <= VertexField::kMaxFields);
  require(request.fields.empty() || order->encoding != v1::ENCODING_COMPACT);
}

/// Our own reader of pieces agrees with protobuf wherever it reads one.
void check_piece(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  grpc::ByteBuffer buffer(&slice, 1);
  const auto piece = read_piece(buffer);
  if (!piece) return;
  v1::UploadGridRequest message;
  require(message.ParseFromString(bytes) && message.has_data());
  std::string data;
  for (const std::string_view part : piece->bytes) data.append(part);
  require(data == message.data().data() && piece->size == data.size());
  require(piece->offset == static_cast<std::uint64_t>(message.data().offset()));
}

}  // namespace

TET_FUZZ_TARGET(request_fuzz) {
  // It tells of each text that is no UTF-8: a hundred thousand lines in ten seconds.
  [[maybe_unused]] static const auto told = google::protobuf::SetLogHandler(nullptr);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  check_stream_request(bytes);
  check_piece(bytes);
  return 0;
}

}  // namespace tet::request_fuzz
