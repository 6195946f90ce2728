// Sessions in this process: each frame is made anew, where a server would make it.
#include <utility>

#include "client/library/api/core_request.h"
#include "client/library/api/local_frames.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/session_impl.h"
#include "client/library/api/to_public.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"

namespace tetstream {
namespace {

tet::TrailerFacts facts_about(const tet::MeshResult& result) {
  tet::TrailerFacts facts{std::nullopt, result.boundary, result.improvement, result.thin_walls};
  if (!result.quality.empty()) facts.quality = result.quality;
  return facts;
}

class LocalFrames final : public FrameMaker<FrameMesh> {
 public:
  LocalFrames(tet::MeshRequest request,
              const WorkOptions& options,
              const tet::Cancellation& cancellation)
      : request_(std::move(request)), pool_(options.threads), cancellation_(cancellation) {}

  template <class Solid>
  Result<FrameMesh> frame(const Solid& solid) {
    auto shape = shape_of(solid);
    if (!shape.ok()) return to_public(shape.status());
    auto made = tet::mesh_volume(pool_, {.shape = *std::move(shape), .request = request_},
                                 cancellation_);
    if (!made.ok()) return to_public(made.status());
    keep_lattice(made->mesh.header, request_);
    const std::uint64_t tets = made->mesh.header.tet_count;
    return FrameMesh{public_mesh(std::move(made->mesh), facts_about(*made)), tets};
  }

  Result<FrameMesh> make(const Volume& /*before*/,
                         const Volume& after,
                         const ReplacedBoxes& /*replaced*/) override {
    return frame(after);
  }
  Result<FrameMesh> make(const Scene& scene) override { return frame(scene); }
  bool is_over() const override { return cancellation_.requested(); }
  bool follows() const override { return false; }
  Status end() override { return {}; }

 private:
  tet::MeshRequest request_;
  tet::TaskPool pool_;
  const tet::Cancellation& cancellation_;
};

template <class Solid>
Result<Session> begin(const Solid& solid,
                      std::optional<Volume> volume,
                      const Request& request,
                      const WorkOptions& options) {
  return guarded([&]() -> Result<Session> {
    absl::StatusOr<tet::MeshRequest> core = session_request(request);
    if (!core.ok()) return to_public(core.status());
    auto session = std::make_unique<Session::Impl>(options);
    auto frames =
        std::make_unique<LocalFrames>(*std::move(core), options, session->work.cancellation());
    Result<FrameMesh> first = frames->frame(solid);
    if (!first.ok()) return first.status();
    session->now = *std::move(first);
    session->volume = std::move(volume);
    session->maker = std::move(frames);
    return Session(std::move(session));
  });
}

}  // namespace

Result<Session> begin_session(const Volume& volume,
                              const Request& request,
                              const WorkOptions& options) {
  return begin(volume, volume, request, options);
}

Result<Session> begin_session(const Scene& scene,
                              const Request& request,
                              const WorkOptions& options) {
  return begin(scene, std::nullopt, request, options);
}

}  // namespace tetstream
