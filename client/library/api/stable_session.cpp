#include "tetstream/stable_session.h"

#include <utility>
#include <vector>

#include "client/library/api/mesh_impl.h"
#include "client/library/api/stable_session_impl.h"
#include "client/library/api/to_public.h"
#include "core/base/parallel.h"

namespace tetstream {
namespace {

std::vector<SlotRange> public_ranges(const std::vector<tet::SlotRange>& ranges) {
  std::vector<SlotRange> result;
  result.reserve(ranges.size());
  for (const tet::SlotRange& range : ranges) {
    result.push_back({range.begin, range.begin + range.count});
  }
  return result;
}

StableMesh view_of(const tet::StableMesh& ids, const std::string& mesh_id) {
  return {.header = to_public(ids.header(), mesh_id),
          .columns = columns_of(ids.slots()),
          .empty_vertices = public_ranges(ids.vertices().free()),
          .empty_tets = public_ranges(ids.tets().free()),
          .changed_vertices = public_ranges(ids.changed_vertices()),
          .changed_tets = public_ranges(ids.changed_tets()),
          .renumbered = ids.renumbered(),
          .memory = ids.memory()};
}

template <class... Frame>
Status update_shown(StableSession::Impl& session, const Frame&... frame) {
  const bool was_over = session.over;
  Status status = session.update(frame...);
  if (status.ok()) {
    // What is shown of the frame before has the next one's columns by now.
    status = guarded([&]() -> Status {
      session.show();
      return {};
    });
    if (!status.ok()) session.over = true;
  }
  if (session.over && !was_over) {
    session.failed = true;
    session.shown = {};
  }
  return status;
}

}  // namespace

void StableSession::Impl::show() { shown = view_of(*now->ids, now->mesh_id); }

StableSession begun(std::unique_ptr<StableSession::Impl> session,
                    std::unique_ptr<FrameMaker<StableFrame>> maker,
                    StableFrame first) {
  session->maker = std::move(maker);
  session->now = std::move(first);
  session->show();
  return StableSession(std::move(session));
}

StableSession::StableSession(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StableSession::~StableSession() = default;
StableSession::StableSession(StableSession&&) noexcept = default;
StableSession& StableSession::operator=(StableSession&&) noexcept = default;

const StableMesh& StableSession::mesh() const noexcept { return impl_->shown; }

Result<Mesh> StableSession::in_order() const {
  if (impl_->failed) {
    return Status(StatusCode::kFailedPrecondition,
                  "a failure has ended the session, and left no mesh: begin another");
  }
  return guarded([&]() -> Result<Mesh> {
    const StableFrame& now = *impl_->now;
    absl::StatusOr<tet::TetMesh> mesh = absl::UnknownError("not started");
    tet::TaskPool pool;
    pool.run([&] { mesh = now.ids->in_order(); });
    if (!mesh.ok()) return to_public(mesh.status());
    return public_mesh(*std::move(mesh), now.facts, now.mesh_id);
  });
}

std::uint64_t StableSession::tets_sent() const noexcept { return impl_->now->tets_sent; }
Status StableSession::update(const Volume& volume) { return update_shown(*impl_, volume); }
Status StableSession::update(const Scene& scene) { return update_shown(*impl_, scene); }
Status StableSession::update(const Volume& volume, std::span<const SampleBox> replaced) {
  return update_shown(*impl_, volume, ReplacedBoxes(replaced));
}
bool StableSession::is_over() const noexcept { return impl_->over; }
Status StableSession::end() { return impl_->end(); }

}  // namespace tetstream
