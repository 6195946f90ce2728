#include "client/library/stream_checks.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/mesh_header.h"

namespace tet {

absl::Status bad_stream(const std::string& message) {
  return absl::DataLossError(absl::StrCat("the server's stream is broken: ", message));
}

absl::StatusOr<MeshHeader> checked_header(const v1::MeshHeader& message) {
  absl::StatusOr<MeshHeader> header = from_proto(message);
  if (header.ok()) return header;
  return bad_stream(absl::StrFormat("header: %s", header.status().message()));
}

}  // namespace tet
