// What a load run asks of whatever answers it: tetstreamd, or a test's stand-in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <absl/status/status.h>

#include "bench/load/load_clock.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

/// What a request asks for its mesh with.
enum class RequestKind : std::uint8_t {
  kStream,  ///< StreamMesh
  kJob,     ///< a batch job: made, waited for, and its result read
};

/// One request of a run.
struct LoadRequest {
  TimePoint intended;                ///< when it is due: latencies count from here
  std::optional<TimePoint> give_up;  ///< its deadline
  std::size_t entry = 0;             ///< of the mix
  std::size_t step = 0;              ///< of the rate profile
  bool measured = true;              ///< false while warming up
  RequestKind kind = RequestKind::kStream;
  bool skip_cache = false;  ///< made even if its result is stored
  tetstream::v1::MeshRequest message;
};

/// How a request ended.
struct Outcome {
  TimePoint sent, ended;
  std::optional<TimePoint> header;  ///< came; of a job: the server keeps it from now on
  std::optional<TimePoint> first_chunk;
  absl::Status status;
  std::uint64_t tets = 0, bytes = 0;  ///< of the chunks that came
};

/// What all requests together have received so far.
struct Traffic {
  std::uint64_t tets = 0, bytes = 0;
};

/// Thread safety: any thread may call any member.
class RequestSender {
 public:
  using Done = std::function<void(const Outcome&)>;

  virtual ~RequestSender() = default;

  /// Sends a request and returns without waiting for it. `done` is called once, on another
  /// thread.
  virtual void send(const LoadRequest& request, Done done) = 0;

  /// Cancels all that were sent: they end soon.
  virtual void give_up() = 0;

  virtual Traffic traffic() const = 0;
};

}  // namespace tet::load
