#include "server/rpc/deadline.h"

#include <chrono>

#include <grpc/support/time.h>

namespace tet {

// gRPC's own conversion counts in nanoseconds, which last for 292 years.
Cancellation::Clock::time_point deadline_of(const grpc::CallbackServerContext& context) {
  using Clock = Cancellation::Clock;
  constexpr std::chrono::hours kFarthest{24 * 365 * 100};
  const gpr_timespec deadline =
      gpr_convert_clock_type(context.raw_deadline(), GPR_CLOCK_REALTIME);
  const auto now =
      std::chrono::duration_cast<std::chrono::seconds>(Clock::now().time_since_epoch());
  if (deadline.tv_sec > (now + kFarthest).count()) return Clock::time_point::max();
  return context.deadline();
}

}  // namespace tet
