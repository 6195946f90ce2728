// A decoder that is ready: it becomes two as often as its parent likes, until it has an order.
#pragma once

#include <optional>

#include "core/vdb/decoder/decoder_protocol.h"

namespace tet {

/// Waits for an order on `socket`, in the process that was asked to copy itself as in its
/// copies, which find their own sockets under the same number. Call it with one thread, before
/// a byte of any file was read. Returns std::nullopt when the process has no more to do.
std::optional<ReceivedOrder> await_order(int socket);

}  // namespace tet
