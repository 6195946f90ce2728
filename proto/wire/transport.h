// gRPC settings that both ends of the wire use, and the memory behind them.
#pragma once

#include <cstddef>

namespace tet {

/// Pieces of an upload: as large as chunks, the size that travels best.
inline constexpr std::size_t kUploadPieceBytes = std::size_t{1} << 19;

/// gRPC channel argument and its value, for client channels and servers alike.
struct TransportSetting {
  const char* name;
  int value;
};

/// Measured over loopback, CPU time of both ends, 512 KiB messages:
/// - the bandwidth probe doubles it, and finds nothing on a LAN;
/// - larger HTTP/2 frames than 16 KiB save 5 %, larger ones than 64 KiB nothing;
/// - a window of eight chunks makes no difference there, keeps a fast link with a longer way
/// busy,
///   and bounds what a stalled reader makes the other end hold.
/// Read chunk sizes, write buffering, write-through and a resource quota made no difference;
/// transmitting without copying (MSG_ZEROCOPY) took four times as long on loopback.
///
/// gRPC would inflate a compressed message whole, a thousandfold, before it looks at the limit
/// on its size. So a peer that says it compresses is refused, and what comes compressed all the
/// same stays as it is, for nobody to understand. Our own messages hardly get smaller: they are
/// packed, or floats.
inline constexpr TransportSetting kTransportSettings[] = {
    {"grpc.http2.bdp_probe", 0},
    {"grpc.http2.max_frame_size", 64 << 10},
    {"grpc.http2.lookahead_bytes", 4 << 20},
    {"grpc.keepalive_time_ms", 60000},
    {"grpc.keepalive_timeout_ms", 20000},
    {"grpc.http2.min_ping_interval_without_data_ms", 30000},
    {"grpc.compression_enabled_algorithms_bitset", 1},  // identity alone
    {"grpc.per_message_decompression", 0},
};

/// What a server says at once of a watch that it has begun, in its initial metadata: a proxy
/// that answers for a server which does not leaves it out.
inline constexpr char kWatchBegun[] = "tetstream-watch-begun";

/// Keeps the blocks that gRPC reads into when they are freed. A program that serves or receives
/// meshes calls this once, before it starts threads. Giving each back to the system and
/// faulting its pages in again would cost as much as all else that the wire does.
void keep_read_blocks() noexcept;

/// Keeps gRPC from writing to stderr what the status of a call tells as well; GRPC_VERBOSITY in
/// the environment lets it.
void quieten_grpc() noexcept;

/// Keeps gRPC when its last channel or server has gone: its end waits up to ten seconds for a
/// thread that polls connections.
void keep_grpc() noexcept;

/// Gives memory that work of another kind left free back to the system, if there is much of it;
/// at most once a second. Any thread may call it.
void give_back_free_memory() noexcept;

}  // namespace tet
