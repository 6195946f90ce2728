// What public sessions hold, of either kind.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <absl/status/statusor.h>

#include "client/library/api/replaced_bricks.h"
#include "client/library/api/work.h"
#include "tetstream/mesh.h"
#include "tetstream/scene.h"
#include "tetstream/session.h"
#include "tetstream/volume.h"

namespace tetstream {

/// A frame's mesh, and how much of it is new.
struct FrameMesh {
  Mesh mesh;
  std::uint64_t tets_sent = 0;
};

/// Makes the mesh of each frame, after the first.
template <class Frame>
class FrameMaker {
 public:
  virtual ~FrameMaker() = default;
  virtual Result<Frame> make(const Volume& before,
                             const Volume& after,
                             const ReplacedBoxes& replaced) = 0;
  virtual Result<Frame> make(const Scene& scene) = 0;
  /// A frame has failed, and nobody can make another.
  virtual bool is_over() const = 0;
  /// Whether it makes a frame from what it holds of the one before. What is thrown meanwhile
  /// may leave it between the two.
  virtual bool follows() const { return true; }
  virtual Status end() = 0;
};

/// A shape that changes, and the frame that is shown of it.
template <class Frame>
class FollowedShape {
 public:
  explicit FollowedShape(const WorkOptions& options) : work(options) {}

  Status update(const Volume& next, const ReplacedBoxes& replaced = std::nullopt);
  Status update(const Scene& scene);
  Status end();

  Work work;  // first: the maker uses its cancellation
  std::unique_ptr<FrameMaker<Frame>> maker;
  std::optional<Volume> volume;  ///< as it is now; nothing in the session of a scene
  std::optional<Frame> now;
  bool over = false;

 private:
  static Status is_past() {
    return {StatusCode::kFailedPrecondition, "the session is over: begin another"};
  }
  /// Takes the next frame, unless it has failed.
  template <class Make>
  Status take(const Make& make) {
    bool has_thrown = true;
    Result<Frame> frame = guarded([&]() -> Result<Frame> {
      Result<Frame> made = make();
      has_thrown = false;
      return made;
    });
    if (!frame.ok()) {
      // The maker may have gone on to a frame that nobody has: a difference from the one that
      // is shown would make a wrong mesh of it.
      over = maker->is_over() || (has_thrown && maker->follows());
      return frame.status();
    }
    now = *std::move(frame);
    return {};
  }
};

template <class Frame>
Status FollowedShape<Frame>::update(const Volume& next, const ReplacedBoxes& replaced) {
  if (over) return is_past();
  if (!volume) {
    return {StatusCode::kInvalidArgument, "the session began with a scene: give it a scene"};
  }
  Status status = take([&] { return maker->make(*volume, next, replaced); });
  if (status.ok()) volume = next;
  return status;
}

template <class Frame>
Status FollowedShape<Frame>::update(const Scene& scene) {
  if (over) return is_past();
  if (volume) {
    return {StatusCode::kInvalidArgument, "the session began with a volume: give it a volume"};
  }
  return take([&] { return maker->make(scene); });
}

template <class Frame>
Status FollowedShape<Frame>::end() {
  if (std::exchange(over, true)) return {};
  return guarded([&] { return maker->end(); });
}

struct Session::Impl : FollowedShape<FrameMesh> {
  using FollowedShape::FollowedShape;
};

}  // namespace tetstream
