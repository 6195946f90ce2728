#include "core/remap/conservative_transfer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "core/remap/common_part.h"
#include "core/remap/linear_transfer.h"

namespace tet {
namespace {

constexpr std::size_t kTetsPerTask = 64;
/// Below this share of a tet's volume nothing of it is beyond the old mesh but rounding.
constexpr double kNothingBeyond = 1e-9;

/// Sums of products; exact to the last bits, so that integrals agree as far as doubles can.
class ExactSum {
 public:
  void add(double term) noexcept {
    const double next = sum_ + term;
    const bool is_smaller = std::abs(sum_) < std::abs(term);
    rest_ += is_smaller ? (term - next) + sum_ : (sum_ - next) + term;
    sum_ = next;
  }
  double value() const noexcept { return sum_ + rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

template <class Term>
std::vector<double> integrate(const std::vector<double>& weights,
                              const Table& table,
                              const Term& term) {
  std::vector<ExactSum> sums(table.width);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    for (std::size_t k = 0; k < table.width; ++k)
      sums[k].add(weights[i] * term(table.row(i)[k], k));
  }
  std::vector<double> values(table.width);
  std::ranges::transform(sums, values.begin(), [](const ExactSum& sum) { return sum.value(); });
  return values;
}

std::vector<double> integrate(const std::vector<double>& weights, const Table& table) {
  return integrate(weights, table, [](double value, std::size_t) { return value; });
}

/// The least and the largest value of each column.
struct Range {
  std::vector<double> least, most;

  explicit Range(const Table& table) : least(table.width), most(table.width) {
    for (std::size_t k = 0; k < table.width && table.rows() > 0; ++k) {
      least[k] = most[k] = table.row(0)[k];
    }
    for (std::size_t i = 0; i < table.rows(); ++i) {
      for (std::size_t k = 0; k < table.width; ++k) {
        least[k] = std::min(least[k], table.row(i)[k]);
        most[k] = std::max(most[k], table.row(i)[k]);
      }
    }
  }
};

/// Makes integrals what they were: every value grows or shrinks by the same share of its size.
void restore_integrals(const std::vector<double>& weights,
                       const std::vector<double>& goal,
                       Table& table) {
  constexpr int kTimes = 2;  // the second time takes back the rounding of the first
  for (int time = 0; time < kTimes; ++time) {
    const std::vector<double> now = integrate(weights, table);
    const std::vector<double> size =
        integrate(weights, table, [](double value, std::size_t) { return std::abs(value); });
    for (std::size_t i = 0; i < table.rows(); ++i) {
      for (std::size_t k = 0; k < table.width; ++k) {
        if (!(size[k] > 0)) continue;
        double& value = table.row(i)[k];
        value += (goal[k] - now[k]) / size[k] * std::abs(value);
      }
    }
  }
}

/// Cuts values off at the range, and gives what was cut off to those that have room.
void clamp_and_restore(const std::vector<double>& weights,
                       const std::vector<double>& goal,
                       const Range& range,
                       Table& table) {
  for (std::size_t i = 0; i < table.rows(); ++i) {
    for (std::size_t k = 0; k < table.width; ++k) {
      table.row(i)[k] = std::clamp(table.row(i)[k], range.least[k], range.most[k]);
    }
  }
  const std::vector<double> now = integrate(weights, table);
  const auto room_of = [&](double value, std::size_t k) {
    return goal[k] > now[k] ? range.most[k] - value : value - range.least[k];
  };
  const std::vector<double> room = integrate(weights, table, room_of);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    for (std::size_t k = 0; k < table.width; ++k) {
      if (!(room[k] > 0)) continue;
      double& value = table.row(i)[k];
      const double share = std::clamp((goal[k] - now[k]) / room[k], -1.0, 1.0);
      value = std::clamp(value + share * room_of(value, k), range.least[k], range.most[k]);
    }
  }
}

/// Fills, for one new tet after the other, what the old ones give it.
class TetFiller {
 public:
  TetFiller(const TetLocator& from,
            const MeshTables& old_tables,
            const DataMesh& to,
            const Cancellation& cancellation,
            Table& per_corner,
            Table& cells)
      : from_(from),
        old_(old_tables),
        to_(to),
        cancellation_(cancellation),
        per_corner_(per_corner),
        cells_(cells) {}

  /// Returns the volume that the tet has in common with the old mesh: nothing of a flat one,
  /// whose pieces have a volume by rounding alone, and shares that are no numbers.
  double fill(std::size_t tet) {
    const TetPlaces place = to_.places(tet);
    const double volume = std::abs(six_volumes(place)) / 6;
    const double common = is_flat(place) ? 0 : add_common(tet, place);
    if (volume - common > kNothingBeyond * volume) add_beyond(tet, place, volume - common);
    divide_by(volume, cells_.width == 0 ? std::span<double>{} : cells_.row(tet));
    return common;
  }

 private:
  /// Returns its volume. A large tet touches all old ones: once cancelled it takes no more.
  double add_common(std::size_t tet, const TetPlaces& place) {
    constexpr std::uint64_t kBetweenLooks = 1024;
    double common = 0;
    std::uint64_t visited = 0;
    bool stops = false;
    from_.visit_touching(box_around(place), [&](std::uint32_t old_tet) {
      stops = stops || (++visited % kBetweenLooks == 0 && cancellation_.requested());
      if (stops) return;
      const TetPlaces old_place = from_.mesh().places(old_tet);
      for (const TetPlaces& piece : common_part_.of(place, old_place)) {
        const double part = std::abs(six_volumes(piece)) / 6;
        if (!(part > 0)) continue;
        common += part;
        add_piece(tet, place, old_tet, old_place, piece, part);
      }
    });
    return common;
  }

  static void divide_by(double volume, std::span<double> row) noexcept {
    for (double& value : row) value = volume > 0 ? value / volume : 0;
  }

  void add_piece(std::size_t tet,
                 const TetPlaces& place,
                 std::uint32_t old_tet,
                 const TetPlaces& old_place,
                 const TetPlaces& piece,
                 double volume) noexcept {
    if (cells_.width > 0) add_row(old_.cells.row(old_tet), volume, cells_.row(tet));
    if (per_corner_.width == 0) return;
    std::array<CornerShares, 4> ours, theirs;
    for (std::size_t c = 0; c < 4; ++c) {
      ours[c] = shares_of(place, piece[c]);
      theirs[c] = shares_of(old_place, piece[c]);
    }
    const auto& corners = from_.mesh().tets[old_tet];
    for (std::size_t k = 0; k < per_corner_.width; ++k) {
      std::array<double, 4> value{};
      for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t j = 0; j < 4; ++j) {
          value[c] += theirs[c][j] * old_.points.row(corners[j])[k];
        }
      }
      add_products(tet, k, ours, value, volume);
    }
  }

  /// What the nearest tet of the old mesh says goes on beyond it.
  void add_beyond(std::size_t tet, const TetPlaces& place, double volume) {
    WorldPoint middle;
    for (const WorldPoint& p : place) {
      middle = {middle.x + p.x / 4, middle.y + p.y / 4, middle.z + p.z / 4};
    }
    const TetLocator::Place near = from_.find(middle);
    if (cells_.width > 0) add_row(old_.cells.row(near.tet), volume, cells_.row(tet));
    if (per_corner_.width == 0) return;
    std::array<CornerShares, 4> ours{};
    std::array<TetLocator::Place, 4> places;
    for (std::size_t c = 0; c < 4; ++c) {
      ours[c][c] = 1;
      places[c] = from_.find(place[c], near.tet);
      places[c].shares = usable_shares(from_, place[c], places[c]);
    }
    for (std::size_t k = 0; k < per_corner_.width; ++k) {
      std::array<double, 4> value{};
      for (std::size_t c = 0; c < 4; ++c) {
        const auto& corners = from_.mesh().tets[places[c].tet];
        for (std::size_t j = 0; j < 4; ++j) {
          value[c] += places[c].shares[j] * old_.points.row(corners[j])[k];
        }
      }
      add_products(tet, k, ours, value, volume);
    }
  }

  /// The integral, over a tet, of each corner's function times what has these values at the
  /// tet's corners.
  void add_products(std::size_t tet,
                    std::size_t k,
                    const std::array<CornerShares, 4>& ours,
                    const std::array<double, 4>& value,
                    double volume) noexcept {
    const double all = value[0] + value[1] + value[2] + value[3];
    for (std::size_t corner = 0; corner < 4; ++corner) {
      double sum = 0, products = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        sum += ours[c][corner];
        products += ours[c][corner] * value[c];
      }
      per_corner_.row(4 * tet + corner)[k] += volume / 20 * (sum * all + products);
    }
  }

  static void add_row(std::span<const double> row,
                      double weight,
                      std::span<double> sum) noexcept {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * row[k];
  }

  const TetLocator& from_;
  const MeshTables& old_;
  const DataMesh& to_;
  const Cancellation& cancellation_;
  Table& per_corner_;
  Table& cells_;
  CommonPart common_part_;
};

Table zeros(std::size_t rows, std::size_t width) {
  return {width, std::vector<double>(rows * width)};
}

}  // namespace

std::vector<double> integrals_of_points(const MassMatrix& mass, const Table& table) {
  return integrate(mass.weights(), table);
}

std::vector<double> integrals_of_cells(const MassMatrix& mass, const Table& table) {
  return integrate(mass.volumes(), table);
}

ConservativeResult transfer_integrals(const TetLocator& from,
                                      const MeshTables& old_tables,
                                      const DataMesh& to,
                                      bool clamp,
                                      const Cancellation& cancellation) {
  const std::size_t tets = to.tets.size();
  Table per_corner = zeros(4 * tets, old_tables.points.width);
  ConservativeResult result;
  result.tables.cells = zeros(tets, old_tables.cells.width);
  std::vector<double> common(tets);
  for_each_range(tets, kTetsPerTask, [&](std::size_t begin, std::size_t end) {
    if (cancellation.requested()) return;
    TetFiller filler(from, old_tables, to, cancellation, per_corner, result.tables.cells);
    for (std::size_t tet = begin; tet < end; ++tet) common[tet] = filler.fill(tet);
  });
  for (const double volume : common) result.common_volume += volume;
  if (cancellation.requested() || !(result.common_volume > 0)) return result;

  const MassMatrix old_mass(from.mesh()), mass(to);
  Table& points = result.tables.points;
  points = zeros(to.points.size(), old_tables.points.width);
  if (points.width > 0) mass.solve(mass.gather(per_corner), points, cancellation);
  const std::vector<double> of_points = integrals_of_points(old_mass, old_tables.points);
  const std::vector<double> of_cells = integrals_of_cells(old_mass, old_tables.cells);
  restore_integrals(mass.weights(), of_points, points);
  restore_integrals(mass.volumes(), of_cells, result.tables.cells);
  if (!clamp) return result;
  clamp_and_restore(mass.weights(), of_points, Range(old_tables.points), points);
  clamp_and_restore(mass.volumes(), of_cells, Range(old_tables.cells), result.tables.cells);
  return result;
}

}  // namespace tet
