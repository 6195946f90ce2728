// Sessions with a server.
#include <algorithm>
#include <utility>

#include "client/library/api/changed_leaves.h"
#include "client/library/api/client_impl.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/session_impl.h"
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

class ServedFrames final : public FrameMaker {
 public:
  ServedFrames(std::shared_ptr<const Client::Impl> client,
               std::unique_ptr<tet::RemeshSession> session,
               const tet::Cancellation& cancellation)
      : client_(std::move(client)), session_(std::move(session)), cancellation_(cancellation) {}

  Result<FrameMesh> now() const {
    const tet::StreamedMesh& mesh = session_->mesh();
    tet::TrailerFacts facts{std::nullopt, mesh.boundary, mesh.improvement, mesh.thin_walls};
    // Where parts were kept it is that of the rest.
    const bool whole = session_->tets_sent() == mesh.mesh.header.tet_count;
    if (whole && !mesh.quality.empty()) facts.quality = mesh.quality;
    return FrameMesh{public_mesh(copy_of(mesh.mesh), facts, mesh.mesh_id),
                     session_->tets_sent()};
  }

  Result<FrameMesh> make(const Volume& before, const Volume& after) override {
    const auto leaves =
        changed_leaves(*before.impl().components.front(), *after.impl().components.front());
    return leaves.ok() ? after_update(session_->update(*leaves)) : to_public(leaves.status());
  }
  Result<FrameMesh> make(const Scene& scene) override {
    const auto message = stored_scene(*client_->meshes, scene, cancellation_);
    return message.ok() ? after_update(session_->update(*message))
                        : to_public(message.status());
  }
  bool is_over() const override { return session_->is_over(); }
  Status end() override { return to_public(session_->end()); }

 private:
  Result<FrameMesh> after_update(const absl::Status& status) const {
    if (!status.ok()) return to_public(status);
    return now();
  }

  const std::shared_ptr<const Client::Impl> client_;
  const std::unique_ptr<tet::RemeshSession> session_;
  const tet::Cancellation& cancellation_;
};

Result<Session> begin_with(const std::shared_ptr<const Client::Impl>& client,
                           const absl::StatusOr<v1::MeshRequest>& message,
                           std::unique_ptr<Session::Impl> session) {
  if (!message.ok()) return to_public(message.status());
  const tet::Cancellation& cancellation = session->work.cancellation();
  auto begun = client->meshes->begin_session(*message, cancellation);
  if (!begun.ok()) return to_public(begun.status());
  auto frames = std::make_unique<ServedFrames>(client, *std::move(begun), cancellation);
  Result<FrameMesh> first = frames->now();
  if (!first.ok()) return first.status();
  session->now = *std::move(first);
  session->maker = std::move(frames);
  return Session(std::move(session));
}

}  // namespace

Result<Session> Client::begin_session(const Volume& volume,
                                      const Request& request,
                                      const WorkOptions& options) const {
  return guarded([&]() -> Result<Session> {
    auto session = std::make_unique<Session::Impl>(options);
    session->volume = volume;
    const tet::Cancellation& cancellation = session->work.cancellation();
    const auto name = upload_volume(*impl_->meshes, volume, {}, cancellation);
    if (!name.ok()) return to_public(name.status());
    const auto message = message_of(*impl_->meshes, StoredVolume{*name}, request, cancellation);
    return begin_with(impl_, message, std::move(session));
  });
}

Result<Session> Client::begin_session(const Scene& scene,
                                      const Request& request,
                                      const WorkOptions& options) const {
  return guarded([&]() -> Result<Session> {
    auto session = std::make_unique<Session::Impl>(options);
    const auto message =
        message_of(*impl_->meshes, scene, request, session->work.cancellation());
    return begin_with(impl_, message, std::move(session));
  });
}

}  // namespace tetstream
