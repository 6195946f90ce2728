// tetstream-decoder: reads one grid file, with OpenVDB where it takes that, hands the result
// back, and exits.
//
// Started by tetstream and tetstreamd only: its one descriptor is a socket to them. It copies
// itself when asked, so that a copy reads the file and the next file finds the program started.
#include <cstdio>
#include <cstring>
#include <string>
#include <unistd.h>

#include <absl/strings/str_format.h>

#include "core/vdb/decoder/await_order.h"
#include "core/vdb/decoder/decode_order.h"
#include "core/vdb/decoder/sandbox.h"

namespace tet {
namespace {

enum ExitCode { kAnswered = 0, kUsage = 2, kNoParent = 3, kNoSandbox = 4 };

int refuse(const DecodeOrder& order, const absl::Status& why) {
  const auto answer = absl::FailedPreconditionError(
      absl::StrFormat("'%s' cannot be read: %s", order.file_name, std::string(why.message())));
  return send_answer(kDecoderSocket, answer) ? kAnswered : kNoParent;
}

int decode_once() {
  if (!enter_custody().ok()) return kNoSandbox;
  prepare_to_carry_out();
  if (!send_ready(kDecoderSocket)) return kNoParent;
  const std::optional<ReceivedOrder> received = await_order(kDecoderSocket);
  if (!received) return kNoParent;
  const auto& [order, file, result] = *received;
  if (order.needs_openvdb) {
    if (absl::Status s = prepare_openvdb(); !s.ok()) return refuse(order, s);
  }
  const absl::Status safe =
      enter_sandbox(order.limits, kDecoderSocket, file.number(), result.number());
  if (!safe.ok()) return kNoSandbox;
  const absl::Status answer = carry_out(order, file.number(), result.number());
  // The sandbox leaves nothing for destructors to do: it kills whoever closes a file.
  ::_exit(send_answer(kDecoderSocket, answer) ? kAnswered : kNoParent);
}

}  // namespace
}  // namespace tet

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "--version") == 0) {
    std::puts("tetstream-decoder " TETSTREAM_VERSION);
    return tet::kAnswered;
  }
  if (argc > 1) {
    std::fputs("tetstream-decoder: started by tetstream and tetstreamd, not by hand\n", stderr);
    return tet::kUsage;
  }
  ::_exit(tet::decode_once());
}
