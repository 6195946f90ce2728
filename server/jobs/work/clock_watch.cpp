#include "server/jobs/work/clock_watch.h"

#include <utility>

namespace tet {

ClockWatch::Finding ClockWatch::compare(const Look& look) {
  const absl::Duration doubt = absl::FromChrono(look.answered - look.asked);
  Finding finding;
  finding.ahead = look.here - look.store;
  finding.differs = absl::AbsDuration(finding.ahead) > kFewSeconds + doubt;
  const absl::Duration steady = absl::FromChrono(look.answered.time_since_epoch());
  const Ahead now{look.store - absl::UnixEpoch() - steady, doubt};
  const std::optional<Ahead> before = std::exchange(store_ahead_, now);
  if (!before) return finding;
  const absl::Duration step = now.time - before->time;
  if (absl::AbsDuration(step) > kFewSeconds + doubt + before->doubt) finding.step = step;
  return finding;
}

}  // namespace tet
