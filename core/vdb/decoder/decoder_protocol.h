// What a decoder and whoever started it say to each other, over one SOCK_SEQPACKET socket.
//
//   decoder  "ready"                       once OpenVDB is initialised
//   parent   "copy yourself"               with the copy's end of a socket, any number of times
//   decoder  the copy's process id         and the copy says "ready" on its own socket
//   parent   an order, with the descriptors of the file and of empty memory for the result
//   decoder  how it went                   and it exits
//
// The decoder believes its parent. The parent believes nothing: an answer has one size, its
// code is one of a few, and its texts are cut to what may be shown.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <sys/types.h>
#include <variant>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"

namespace tet {

/// The descriptor under which a decoder finds its socket.
inline constexpr int kDecoderSocket = 3;

inline constexpr std::size_t kMaxFailureBytes = 500;

enum class DecodeTask : std::uint32_t {
  kVolume = 1,       ///< one grid, as a flat volume
  kGridList = 2,     ///< what the file holds, as a flat grid list
  kField = 3,        ///< one component of one grid's values, as a flat volume
  kLabels = 4,       ///< one image's or grid's labels, as a flat label volume
  kValues = 5,       ///< what one grid's values tell, as flat grid contents
  kLabelCounts = 6,  ///< which labels one image or grid has, as flat grid contents
};

/// What a decoder may take.
struct DecodeLimits {
  std::uint64_t result_bytes = 0;   ///< of the flat result
  std::uint64_t working_bytes = 0;  ///< address space beyond what it has when it begins
  std::uint64_t cpu_seconds = 0;
};

struct DecodeOrder {
  DecodeTask task = DecodeTask::kVolume;
  DecodeLimits limits;
  std::int64_t file_bytes = 0;
  std::string file_name;  ///< what messages call the file; its end if it is long
  std::string grid_name;  ///< at most kMaxGridNameBytes; empty takes the only one that will do
  std::uint32_t component = 0;  ///< of a field
  bool needs_openvdb = true;    ///< unless the file holds what is read without
};

/// An order as it came, with its descriptors.
struct ReceivedOrder {
  DecodeOrder order;
  Descriptor file, result;
};

/// The wish that the process becomes two, of which one answers on this socket.
struct ReceivedCopyWish {
  Descriptor socket;
};

/// What the parent asks for; std::monostate when it is gone or says something else.
using ReceivedWish = std::variant<std::monostate, ReceivedCopyWish, ReceivedOrder>;

/// Both sides send with these; false when the other side is gone.
bool send_ready(int socket);
bool send_copy_wish(int socket, int socket_of_copy);
bool send_copied(int socket, pid_t copy);
bool send_order(int socket, const DecodeOrder& order, int file, int result);
bool send_answer(int socket, const absl::Status& answer);

/// The decoder's; waits.
ReceivedWish receive_wish(int socket);

/// The parent's; does not wait. False or nothing when there is no message, or another one.
bool receive_ready(int socket);
std::optional<pid_t> receive_copied(int socket);
/// Ok, or kInvalidArgument, kNotFound, kFailedPrecondition or kResourceExhausted with at most
/// 500 bytes of printable ASCII; and DECODER_MEMORY or no name.
std::optional<absl::Status> receive_answer(int socket);

}  // namespace tet
