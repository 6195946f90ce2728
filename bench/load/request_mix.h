// Which requests a run sends, and how often each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bench/load/request_sender.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

struct IsoRange {
  double low = 0, high = 0;
};

/// One kind of request.
struct MixEntry {
  std::string label;  ///< what the user wrote
  double weight = 1;  ///< how often, compared to the others; positive
  tetstream::v1::MeshRequest message;
  std::optional<IsoRange> iso;  ///< each request takes its own from here, uniformly
  /// Each request asks for a mesh that the server has not planned before: the spacing, which
  /// must be set, grows by 1e-15 of itself for each that the mix has drawn.
  bool fresh = false;
  /// How many it counts as drawn before its first: another number in each run, as a server may
  /// know the meshes of those before.
  std::uint64_t fresh_from = 0;
  std::int64_t tet_count = 0;  ///< of the message as it is
  RequestKind kind = RequestKind::kStream;
  bool skip_cache = false;
};

/// Where a run may begin to count its fresh meshes: of 2^30 places, so that hardly two runs of
/// a million requests meet, and spacings grow by no more than 1.1e-6 of themselves.
std::uint64_t draw_fresh_from();

/// Draws requests at random. Not thread-safe.
class RequestMix {
 public:
  explicit RequestMix(std::vector<MixEntry> entries);

  const std::vector<MixEntry>& entries() const { return entries_; }

  struct Drawn {
    std::size_t entry = 0;
    tetstream::v1::MeshRequest message;
  };
  /// Draws an entry and an iso value, which depend on the state of `random` alone; of fresh
  /// entries the spacing does not.
  Drawn draw(std::mt19937_64& random);

 private:
  std::size_t draw_entry(std::mt19937_64& random) const;

  std::vector<MixEntry> entries_;
  double weight_ = 0;
  std::uint64_t drawn_ = 0;
};

}  // namespace tet::load
