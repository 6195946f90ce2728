// What a public session of stable ids holds.
#pragma once

#include <cstdint>
#include <string>

#include "client/library/api/session_impl.h"
#include "client/library/chunk_supply.h"
#include "core/mesh/stable/stable_mesh.h"
#include "tetstream/stable_session.h"

namespace tetstream {

/// A frame as its maker holds it.
struct StableFrame {
  const tet::StableMesh* ids = nullptr;  ///< the maker's
  tet::TrailerFacts facts = {};
  std::string mesh_id = {};
  std::uint64_t tets_sent = 0;
};

struct StableSession::Impl : FollowedShape<StableFrame> {
  using FollowedShape::FollowedShape;

  /// What is shown becomes the frame that there is now: none where a failure ended the session.
  void show();

  StableMesh shown;
  bool failed = false;
};

/// Begins a session whose maker has made its first frame.
StableSession begun(std::unique_ptr<StableSession::Impl> session,
                    std::unique_ptr<FrameMaker<StableFrame>> maker,
                    StableFrame first);

}  // namespace tetstream
