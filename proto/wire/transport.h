// HTTP/2 settings that both ends of the wire use; measured, see docs.
#pragma once

#include <cstdint>

namespace tet {

/// Pieces of an upload: as large as chunks, the size that travels best.
inline constexpr std::int64_t kUploadPieceBytes = 1 << 20;

/// gRPC channel argument and its value, for client channels and servers alike.
struct TransportSetting {
  const char* name;
  int value;
};

/// The bandwidth probe costs more than it finds on a LAN; a window of four chunks keeps a fast
/// link busy and bounds what a stalled reader can make the server hold.
inline constexpr TransportSetting kTransportSettings[] = {
    {                        "grpc.http2.bdp_probe",       0},
    {                  "grpc.http2.lookahead_bytes", 4 << 20},
    {                      "grpc.keepalive_time_ms",   60000},
    {                   "grpc.keepalive_timeout_ms",   20000},
    {"grpc.http2.min_ping_interval_without_data_ms",   30000},
};

}  // namespace tet
