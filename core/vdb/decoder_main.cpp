// tetstream-decoder: reads one .vdb file with OpenVDB, hands the result back, and exits.
//
// Started by tetstream and tetstreamd only: its one descriptor is a socket to them. It copies
// itself when asked, so that a copy reads the file and the next file finds the program started.
#include <cstdio>
#include <cstring>
#include <unistd.h>

#include "core/vdb/await_order.h"
#include "core/vdb/decode_order.h"
#include "core/vdb/idle_threads.h"
#include "core/vdb/sandbox.h"

namespace tet {
namespace {

enum ExitCode { kAnswered = 0, kUsage = 2, kNoParent = 3, kNoSandbox = 4 };

int decode_once() {
  if (!enter_custody().ok()) return kNoSandbox;
  prepare_to_carry_out();
  // A copy has no other thread, and would wait for ever for what one of them holds.
  if (!await_idle_threads().ok()) return kNoSandbox;
  if (!send_ready(kDecoderSocket)) return kNoParent;
  const std::optional<ReceivedOrder> received = await_order(kDecoderSocket);
  if (!received) return kNoParent;
  const auto& [order, file, result] = *received;
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
