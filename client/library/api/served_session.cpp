// Sessions with a server, of either kind.
#include <algorithm>
#include <concepts>
#include <utility>

#include "client/library/api/changed_leaves.h"
#include "client/library/api/client_impl.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/session_impl.h"
#include "client/library/api/stable_session_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/volume_impl.h"
#include "client/library/remesh_session.h"

namespace tetstream {
namespace {

/// The session goes on from the mesh that it holds, and its caller keeps this one.
tet::TetMesh copy_of(const tet::TetMesh& mesh) {
  tet::TetMesh copy(mesh.header);
  const auto fill = [](tet::ByteBuffer& to, const tet::ByteBuffer& from) {
    std::ranges::copy(from.bytes(), to.bytes().begin());
  };
  fill(copy.positions, mesh.positions);
  fill(copy.tets, mesh.tets);
  fill(copy.regions, mesh.regions);
  fill(copy.fields, mesh.fields);
  fill(copy.faces, mesh.faces);
  fill(copy.face_tets, mesh.face_tets);
  fill(copy.face_labels, mesh.face_labels);
  return copy;
}

tet::TrailerFacts facts_about(const tet::RemeshSession& session) {
  const tet::StreamedMesh& mesh = session.mesh();
  tet::TrailerFacts facts{std::nullopt, mesh.boundary, mesh.improvement, mesh.thin_walls};
  // Where parts were kept it is that of the rest.
  const bool whole = session.tets_sent() == mesh.mesh.header.tet_count;
  if (whole && !mesh.quality.empty()) facts.quality = mesh.quality;
  return facts;
}

template <class Frame>
class ServedFrames final : public FrameMaker<Frame> {
 public:
  ServedFrames(std::shared_ptr<const Client::Impl> client,
               std::unique_ptr<tet::RemeshSession> session,
               const tet::Cancellation& cancellation)
      : client_(std::move(client)), session_(std::move(session)), cancellation_(cancellation) {}

  Frame now() const {
    const tet::StreamedMesh& mesh = session_->mesh();
    const tet::TrailerFacts facts = facts_about(*session_);
    if constexpr (std::same_as<Frame, StableFrame>) {
      return {session_->stable(), facts, mesh.mesh_id, session_->tets_sent()};
    } else {
      return {public_mesh(copy_of(mesh.mesh), facts, mesh.mesh_id), session_->tets_sent()};
    }
  }

  Result<Frame> make(const Volume& before,
                     const Volume& after,
                     const ReplacedBoxes& replaced) override {
    const auto bricks = replaced_bricks(before, after, replaced);
    if (!bricks.ok()) return to_public(bricks.status());
    const auto leaves =
        changed_leaves(*before.impl().components.front(), *after.impl().components.front(),
                       cancellation_, *bricks ? &**bricks : nullptr);
    return leaves.ok() ? after_update(session_->update(*leaves)) : to_public(leaves.status());
  }
  Result<Frame> make(const Scene& scene) override {
    const auto message = stored_scene(*client_->meshes, scene, cancellation_);
    return message.ok() ? after_update(session_->update(*message))
                        : to_public(message.status());
  }
  bool is_over() const override { return session_->is_over() || cancellation_.requested(); }
  Status end() override { return to_public(session_->end()); }

 private:
  Result<Frame> after_update(const absl::Status& status) const {
    if (!status.ok()) return to_public(status);
    return now();
  }

  const std::shared_ptr<const Client::Impl> client_;
  const std::unique_ptr<tet::RemeshSession> session_;
  const tet::Cancellation& cancellation_;
};

Session begun(std::unique_ptr<Session::Impl> session,
              std::unique_ptr<FrameMaker<FrameMesh>> maker,
              FrameMesh first) {
  session->now = std::move(first);
  session->maker = std::move(maker);
  return Session(std::move(session));
}

/// Uploads what the session begins with, and names it.
absl::StatusOr<v1::MeshRequest> message_with(const Client::Impl& client,
                                             const Volume& volume,
                                             const Request& request,
                                             const tet::Cancellation& cancellation) {
  const auto name = upload_volume(*client.meshes, volume, {}, cancellation);
  if (!name.ok()) return name.status();
  return message_of(*client.meshes, StoredVolume{*name}, request, cancellation);
}
absl::StatusOr<v1::MeshRequest> message_with(const Client::Impl& client,
                                             const Scene& scene,
                                             const Request& request,
                                             const tet::Cancellation& cancellation) {
  return message_of(*client.meshes, scene, request, cancellation);
}

template <class Kind, class Frame, class Solid>
Result<Kind> begin_with(const std::shared_ptr<const Client::Impl>& client,
                        const Solid& solid,
                        const Request& request,
                        const WorkOptions& options) {
  return guarded([&]() -> Result<Kind> {
    auto session = std::make_unique<typename Kind::Impl>(options);
    if constexpr (std::same_as<Solid, Volume>) session->volume = solid;
    const tet::Cancellation& cancellation = session->work.cancellation();
    const auto message = message_with(*client, solid, request, cancellation);
    if (!message.ok()) return to_public(message.status());
    constexpr tet::SessionIds kIds =
        std::same_as<Frame, StableFrame> ? tet::SessionIds::kStable : tet::SessionIds::kInOrder;
    auto served = client->meshes->begin_session(*message, cancellation, kIds);
    if (!served.ok()) return to_public(served.status());
    auto frames =
        std::make_unique<ServedFrames<Frame>>(client, *std::move(served), cancellation);
    Frame first = frames->now();
    return begun(std::move(session), std::move(frames), std::move(first));
  });
}

}  // namespace

Result<Session> Client::begin_session(const Volume& volume,
                                      const Request& request,
                                      const WorkOptions& options) const {
  return begin_with<Session, FrameMesh>(impl_, volume, request, options);
}

Result<Session> Client::begin_session(const Scene& scene,
                                      const Request& request,
                                      const WorkOptions& options) const {
  return begin_with<Session, FrameMesh>(impl_, scene, request, options);
}

Result<StableSession> Client::begin_stable_session(const Volume& volume,
                                                   const Request& request,
                                                   const WorkOptions& options) const {
  return begin_with<StableSession, StableFrame>(impl_, volume, request, options);
}

Result<StableSession> Client::begin_stable_session(const Scene& scene,
                                                   const Request& request,
                                                   const WorkOptions& options) const {
  return begin_with<StableSession, StableFrame>(impl_, scene, request, options);
}

}  // namespace tetstream
