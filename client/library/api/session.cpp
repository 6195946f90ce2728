#include "tetstream/session.h"

#include <utility>

#include "client/library/api/session_impl.h"

namespace tetstream {
namespace {

Status over() {
  return {StatusCode::kFailedPrecondition, "the session is over: begin another"};
}

/// Takes the next frame, unless it has failed.
Status take(Session::Impl& session, Result<FrameMesh> frame) {
  if (!frame.ok()) {
    session.over = session.maker->is_over();
    return frame.status();
  }
  session.now = *std::move(frame);
  return {};
}

}  // namespace

Session::Session(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

const Mesh& Session::mesh() const noexcept { return impl_->now->mesh; }

std::uint64_t Session::tets_sent() const noexcept { return impl_->now->tets_sent; }

Status Session::update(const Volume& volume) {
  if (impl_->over) return over();
  if (!impl_->volume) {
    return {StatusCode::kInvalidArgument, "the session began with a scene: give it a scene"};
  }
  Status status = take(*impl_, guarded([&]() -> Result<FrameMesh> {
    return impl_->maker->make(*impl_->volume, volume);
  }));
  if (status.ok()) impl_->volume = volume;
  return status;
}

Status Session::update(const Scene& scene) {
  if (impl_->over) return over();
  if (impl_->volume) {
    return {StatusCode::kInvalidArgument, "the session began with a volume: give it a volume"};
  }
  return take(*impl_,
              guarded([&]() -> Result<FrameMesh> { return impl_->maker->make(scene); }));
}

bool Session::is_over() const noexcept { return impl_->over; }

Status Session::end() {
  if (std::exchange(impl_->over, true)) return {};
  return guarded([&] { return impl_->maker->end(); });
}

}  // namespace tetstream
