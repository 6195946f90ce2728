#include "core/mesh/improve/improve_labels.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/scratch_pool.h"
#include "core/mesh/improve/angle_survey.h"
#include "core/mesh/improve/label_mover.h"
#include "core/mesh/improve/sweeper.h"

namespace tet {
namespace {

/// Vertices that are relaxed make room for others to be brought nearer. With four rounds curves
/// of exact fields end at 0.097 spacings.
constexpr int kRounds = 4;

/// The stars around all vertices between labels would take several times as much memory as the
/// mesh: they are looked at in so many parts, of at least so many vertices.
constexpr std::size_t kParts = 8, kLeastPart = std::size_t{1} << 16;

/// Scratch memory of one task.
struct MoverSlot {
  std::optional<LabelMover> mover;
};

/// Makes movers that use one another's memory.
class Movers {
 public:
  using Move = LabelMover::Outcome (LabelMover::*)(std::uint64_t, std::span<const TetCorner>);

  Movers(const TetMesh& mesh,
         const LabelledSpace& space,
         const MeshView& before,
         const AngleRange& angles)
      : mesh_(mesh), space_(space), before_(before), angles_(angles) {}

  /// What moves the vertices of one task.
  class Mover {
   public:
    Mover(Movers& all, Move how) : turn_(all.slots_), how_(how) {
      if (!turn_->mover) turn_->mover.emplace(all.mesh_, all.space_, all.before_, all.angles_);
    }
    LabelMover::Outcome move(std::uint64_t vertex,
                             std::span<const TetCorner> star,
                             const WorldPoint&) {
      return (*turn_->mover.*how_)(vertex, star);
    }

   private:
    ScratchPool<MoverSlot>::Turn turn_;
    const Move how_;
  };

 private:
  const TetMesh& mesh_;
  const LabelledSpace& space_;
  const MeshView before_;
  const AngleRange angles_;
  ScratchPool<MoverSlot> slots_;
};

/// Improves one mesh, round after round.
class LabelImprover {
 public:
  LabelImprover(TetMesh& mesh,
                const LabelledSpace& space,
                const AngleSurvey& survey,
                const Cancellation& cancellation)
      : mesh_(mesh),
        space_(space),
        cancellation_(cancellation),
        first_positions_(mesh.positions.size()),
        survey_(survey) {
    std::ranges::copy(mesh.positions.bytes(), first_positions_.bytes().begin());
    before_ = mesh.view();
    before_.positions = first_positions_.bytes();
  }

  /// Brings vertices nearer to where their labels meet; the rest of them is what may be brought
  /// nearer still.
  void bring_nearer(std::vector<std::uint64_t>& vertices) {
    Movers movers(mesh_, space_, before_, survey_.angles);
    Movers::Move how = nullptr;
    std::vector<std::uint64_t> rest;
    const std::size_t part = std::max(kLeastPart, vertices.size() / kParts + 1);
    for (std::size_t begin = 0; begin < vertices.size(); begin += part) {
      const std::size_t count = std::min(part, vertices.size() - begin);
      Sweeper sweeper(mesh_,
                      VertexStars::around(mesh_, std::span(vertices).subspan(begin, count)),
                      [&] { return Movers::Mover(movers, how); });
      for (const Movers::Move next : {&LabelMover::approach, &LabelMover::approach_aside}) {
        how = next;
        sweeper.sweep(cancellation_);
      }
      if (cancellation_.requested()) return;
      sweeper.for_each_open([&](std::uint64_t vertex) { rest.push_back(vertex); });
    }
    vertices = std::move(rest);
    survey_ = survey_angles(mesh_, good_angles());
  }

  /// Gives poor tets better angles.
  void relax() {
    if (survey_.bad_tets.empty() || cancellation_.requested()) return;
    Movers movers(mesh_, space_, before_, survey_.angles);
    Sweeper sweeper(mesh_, VertexStars(mesh_, survey_.bad_tets),
                    [&] { return Movers::Mover(movers, &LabelMover::relax); });
    sweeper.sweep(cancellation_);
    survey_ = survey_angles(mesh_, good_angles());
  }

  std::uint64_t moved_vertices() const {
    std::uint64_t moved = 0;
    for (std::uint64_t v = 0; v < mesh_.header.vertex_count; ++v) {
      moved += mesh_.stored_position(v) == before_.stored_position(v) ? 0U : 1U;
    }
    return moved;
  }

 private:
  TetMesh& mesh_;
  const LabelledSpace& space_;
  const Cancellation& cancellation_;
  ByteBuffer first_positions_;
  MeshView before_;
  AngleSurvey survey_;
};

std::vector<std::uint64_t> ids_of(std::span<const std::uint8_t> wanted) {
  std::vector<std::uint64_t> ids;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] != 0) ids.push_back(i);
  }
  return ids;
}

}  // namespace

Improvement improve_labels(TetMesh& mesh,
                           const LabelledSpace& space,
                           std::span<const std::uint8_t> at_interface,
                           const Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const AngleSurvey survey = survey_angles(mesh, good_angles());
  Improvement improvement = improvement_from(survey);
  LabelImprover improver(mesh, space, survey, cancellation);
  std::vector<std::uint64_t> open = ids_of(at_interface);
  for (int round = 0; round < kRounds && !cancellation.requested(); ++round) {
    improver.bring_nearer(open);
    improver.relax();
  }
  improvement.moved_vertices = improver.moved_vertices();
  improvement.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return improvement;
}

}  // namespace tet
