// What a survey finds of one brick after another, and how it becomes columns.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/base/cancel.h"
#include "core/plan/brick/survey.h"
#include "core/plan/budget.h"

namespace tet {

struct SurveyedBrick {
  StuffedBrick stuffed;
  BrickMask finest;
  std::unique_ptr<FanMasks> fans;  ///< where both sides are meshed
  SurveyedSurface surface;
  /// Where the surface is not known to be one sheet.
  std::shared_ptr<const SurfaceParts> parts;
  bool at_domain_face = false;  ///< some tet near a face of the domain is cut or moved
};

/// What was found of each of some candidates.
struct Findings {
  // Most candidates have no part in the surface where the lattice is finer than the voxels.
  std::vector<std::unique_ptr<SurveyedBrick>> surveyed;
  /// The place in the earlier survey of those it still holds of.
  std::vector<std::uint32_t> known;
  std::vector<const std::byte*> geometry;        ///< where it is kept
  std::vector<std::unique_ptr<ThinSpots>> thin;  ///< null where there are none

  explicit Findings(std::size_t candidates);

  /// How many the surface reaches.
  std::size_t count() const noexcept;
};

/// What may follow: candidates, and bricks that are kept of all.
struct StillToCome {
  std::size_t candidates = 0;
  std::size_t most_bricks = 0;
};

/// Appends what was found, in the order of the candidates, and lets go of it. `earlier` may be
/// null.
void add_findings(std::span<const BrickCoord> candidates,
                  Findings findings,
                  const EarlierSurvey* earlier,
                  bool both_sides,
                  const StillToCome& rest,
                  Survey& survey);

/// What few bricks of a survey that grows have: parts of the surface, and thin walls.
class RareFindings {
 public:
  /// Memory that they take; each is looked at once.
  RareBytes bytes_of(const Survey& survey) noexcept;

 private:
  std::size_t counted_ = 0;
  std::uint64_t parts_bytes_ = 0;
};

/// How many bricks' geometry is kept.
std::uint64_t count_kept(const KeptGeometry& geometry) noexcept;

/// Whether a survey may keep the blocks of an earlier one as they are, with what has gone from
/// them: no more than half as many bricks as are there, and in half of `room`, bytes, so that
/// what is new has its place.
bool can_share(const KeptGeometry& earlier, std::uint64_t room) noexcept;

/// Packs the geometry of one brick after another, as long as there is room for it.
class GeometryKeeper {
 public:
  /// `room` is what all keepers together may still take, bytes; `kept` gets the place of each
  /// brick that was kept.
  GeometryKeeper(std::atomic<std::int64_t>& room, std::vector<const std::byte*>& kept)
      : room_(room), kept_(kept) {}

  void keep(std::size_t brick, const StuffedBrick& stuffed, const StuffedLattice& lattice);

  /// Keeps the geometry of a brick that was packed before; `packed` is null where it was not.
  void keep_again(std::size_t brick, const StuffedBrick& stuffed, const std::byte* packed);

  /// Moves all of it to where it stays; null where there is none.
  std::shared_ptr<const std::byte[]> take();

 private:
  /// Null where there is none.
  std::byte* make_room(std::size_t brick, const StuffedBrick& stuffed);

  std::atomic<std::int64_t>& room_;
  std::vector<const std::byte*>& kept_;
  std::vector<std::byte> packed_;
  std::vector<std::pair<std::size_t, std::size_t>> begins_;
};

}  // namespace tet
