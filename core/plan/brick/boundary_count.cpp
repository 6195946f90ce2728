#include "core/plan/brick/boundary_count.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/brick_neighbours.h"
#include "core/base/parallel.h"
#include "core/base/union_find.h"

namespace tet {
namespace {

/// The surface as pieces that each hang together: the sheet of a brick, or the parts near it.
class SurfacePieces {
 public:
  explicit SurfacePieces(const Survey& survey)
      : survey_(survey),
        parts_(survey.bricks.size()),
        first_(first_pieces()),
        pieces_(first_.back()) {}

  /// Unites what neighbouring bricks share; what is left are the components.
  std::uint64_t count_components(const Cancellation& cancellation) {
    BrickNeighbours neighbours(survey_.bricks), later(survey_.bricks, RowsAround::kLater);
    for (std::size_t i = 0; i < survey_.bricks.size() && !cancellation.requested(); ++i) {
      if (is_sheet(i)) {
        if (survey_.sheets[i].later != 0) unite_sheet(i, later.around(survey_.bricks[i]));
      } else if (parts_[i] != nullptr) {
        unite_parts(i, neighbours.around(survey_.bricks[i]));
      }
    }
    return pieces_.sets();
  }

 private:
  std::vector<std::uint64_t> first_pieces() {
    for (const PartsOfBrick& of_brick : survey_.parts)
      parts_[of_brick.brick] = of_brick.parts.get();
    return offsets_from_counts(survey_.bricks.size(), [&](std::size_t i) {
      if (parts_[i] != nullptr) return std::uint64_t{parts_[i]->count};
      return std::uint64_t{is_sheet(i) ? 1U : 0U};
    });
  }

  bool is_sheet(std::size_t brick) const noexcept { return survey_.sheets[brick].one; }

  void unite_with_sheet(std::uint64_t piece, std::uint32_t brick) {
    if (brick != kNoBrick && is_sheet(brick)) pieces_.unite(piece, first_[brick]);
  }

  void unite_sheet(std::size_t brick, const PlacesAround& around) {
    for (unsigned later = survey_.sheets[brick].later; later != 0; later &= later - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(later));
      unite_with_sheet(first_[brick], around[kItself + 1 + bit]);
    }
  }

  void unite_parts(std::size_t brick, const PlacesAround& around) {
    const SurfaceParts& parts = *parts_[brick];
    for (std::size_t p = 0; p < parts.count; ++p) {
      for (BricksAround beside = parts.beside[p]; beside != 0; beside &= beside - 1) {
        const auto place = static_cast<std::size_t>(std::countr_zero(beside));
        unite_with_sheet(first_[brick] + p, around[place]);
      }
    }
    unite_links(first_[brick], parts.links, around);
  }

  /// Bricks around that have parts, and those of them that have but one.
  struct PartsAround {
    BricksAround any = 0, one = 0;
  };

  PartsAround parts_around(const PlacesAround& around) const noexcept {
    PartsAround found;
    for (std::size_t place = 0; place < around.size(); ++place) {
      if (around[place] == kNoBrick || parts_[around[place]] == nullptr) continue;
      found.any |= BricksAround{1} << place;
      if (parts_[around[place]]->count == 1) found.one |= BricksAround{1} << place;
    }
    return found;
  }

  void unite_links(std::uint64_t first,
                   const std::vector<SurfaceLink>& links,
                   const PlacesAround& around) {
    const PartsAround with = parts_around(around);
    // To a brick of one part the first link of a part says all.
    BricksAround asked = with.any;
    std::uint16_t of_part = 0;
    // Where the last link to each brick led, and the pieces that it united: most links of a
    // part unite the same ones again.
    std::array<std::size_t, 27> found{};
    std::array<std::pair<std::uint64_t, std::uint64_t>, 27> united{};
    for (const SurfaceLink& link : links) {
      if (std::exchange(of_part, link.part) != link.part) asked = with.any;
      const auto [x, y, z] = link.to_brick;
      const auto place = static_cast<std::size_t>(9 * (x + 1) + 3 * (y + 1) + z + 1);
      const BricksAround bit = BricksAround{1} << place;
      if ((asked & bit) == 0) continue;
      asked &= ~(with.one & bit);
      const std::uint32_t other = around[place];
      const auto part = parts_[other]->part(link.element, found[place]);
      if (!part) continue;
      const std::pair pieces(first + link.part, first_[other] + *part);
      if (std::exchange(united[place], pieces) == pieces) continue;
      pieces_.unite(pieces.first, pieces.second);
    }
  }

  const Survey& survey_;
  std::vector<const SurfaceParts*>
      parts_;                         // of each brick; null where it has one sheet, or none
  std::vector<std::uint64_t> first_;  // piece of each brick
  UnionFind pieces_;
};

}  // namespace

std::optional<BoundaryTopology> count_boundary(const Survey& survey,
                                               const Cancellation& cancellation) {
  if (survey.box_cuts_surface) return std::nullopt;
  SurfaceCounts surface;
  for (const SurfaceCounts& of_brick : survey.counts) surface.add(of_brick);
  return BoundaryTopology{
      .triangles = surface.triangles,
      .vertices = surface.vertices,
      .components = SurfacePieces(survey).count_components(cancellation),
      .euler_characteristic = surface.euler_characteristic(),
      .non_manifold_edges = surface.non_manifold_edges,
      .non_manifold_vertices = surface.non_manifold_vertices,
      .restored_nodes = survey.restored == nullptr ? 0 : survey.restored->count()};
}

}  // namespace tet
