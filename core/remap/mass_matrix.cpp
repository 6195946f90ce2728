#include "core/remap/mass_matrix.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/parallel.h"
#include "core/remap/tet_coordinates.h"

namespace tet {
namespace {

constexpr std::size_t kRowsPerRun = 4096;

/// Sums over rows for each column, run by run: the same for any number of threads.
template <class Term>
std::vector<double> sum_rows(std::size_t rows, std::size_t width, const Term& term) {
  std::vector<std::vector<double>> runs((rows + kRowsPerRun - 1) / kRowsPerRun);
  for_each_index(runs.size(), [&](std::size_t r) {
    runs[r].resize(width);
    const std::size_t end = std::min(rows, (r + 1) * kRowsPerRun);
    for (std::size_t i = r * kRowsPerRun; i < end; ++i) {
      for (std::size_t k = 0; k < width; ++k) runs[r][k] += term(i, k);
    }
  });
  std::vector<double> sums(width);
  for (const std::vector<double>& run : runs) {
    for (std::size_t k = 0; k < width; ++k) sums[k] += run[k];
  }
  return sums;
}

std::vector<double> dot(const Table& a, const Table& b) {
  return sum_rows(a.rows(), a.width,
                  [&](std::size_t i, std::size_t k) { return a.row(i)[k] * b.row(i)[k]; });
}

template <class Update>
void update_rows(Table& table, const Update& update) {
  for_each_index(
      table.rows(),
      [&](std::size_t i) {
        for (std::size_t k = 0; k < table.width; ++k) update(table.row(i)[k], i, k);
      },
      kRowsPerRun);
}

/// For each column the power of two of its largest number.
std::vector<int> exponents_of(const Table& table) {
  std::vector<double> largest(table.width);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    for (std::size_t k = 0; k < table.width; ++k) {
      largest[k] = std::max(largest[k], std::abs(table.row(i)[k]));
    }
  }
  std::vector<int> exponents(table.width);
  std::ranges::transform(largest, exponents.begin(), [](double value) {
    return value > 0 && std::isfinite(value) ? std::ilogb(value) : 0;
  });
  return exponents;
}

/// Multiplies each column by a power of two, which rounds nothing.
void scale_columns(Table& table, const std::vector<int>& exponents, int sign) {
  update_rows(table, [&](double& value, std::size_t /*row*/, std::size_t k) {
    value = std::ldexp(value, sign * exponents[k]);
  });
}

}  // namespace

MassMatrix::MassMatrix(const DataMesh& mesh)
    : mesh_(mesh), volumes_(mesh.tets.size()), weights_(mesh.points.size()) {
  for_each_index(
      mesh.tets.size(),
      [&](std::size_t i) { volumes_[i] = std::abs(six_volumes(mesh.places(i))) / 6; },
      kRowsPerRun);
  std::vector<std::uint32_t> count(mesh.points.size());
  for (const auto& tet : mesh.tets) {
    for (const std::uint32_t point : tet) ++count[point];
  }
  first_ = offsets_from_counts(count.size(), [&](std::size_t i) { return count[i]; });
  corners_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
    for (std::size_t k = 0; k < 4; ++k) corners_[next[mesh.tets[tet][k]]++] = 4 * tet + k;
  }
  for_each_index(
      weights_.size(),
      [&](std::size_t point) {
        add_corners(point, [&](std::size_t tet, std::size_t /*corner*/) {
          weights_[point] += volumes_[tet] / 4;
        });
      },
      kRowsPerRun);
}

template <class OfCorner>
void MassMatrix::add_corners(std::size_t point, const OfCorner& of_corner) const {
  for (std::uint64_t at = first_[point]; at < first_[point + 1]; ++at) {
    of_corner(corners_[at] / 4, corners_[at] % 4);
  }
}

Table MassMatrix::gather(const Table& per_corner) const {
  Table sums{per_corner.width, std::vector<double>(mesh_.points.size() * per_corner.width)};
  for_each_index(
      mesh_.points.size(),
      [&](std::size_t point) {
        const auto sum = sums.row(point);
        add_corners(point, [&](std::size_t tet, std::size_t corner) {
          const auto row = per_corner.row(4 * tet + corner);
          for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += row[k];
        });
      },
      kRowsPerRun);
  return sums;
}

/// The integral of the product of two corners' functions is a twentieth of the volume, twice
/// that of a square.
void MassMatrix::multiply(const Table& x, Table& y) const {
  for_each_index(
      mesh_.points.size(),
      [&](std::size_t point) {
        const std::span<double> sum = y.row(point);
        const std::span<const double> own = x.row(point);
        std::ranges::fill(sum, 0);
        add_corners(point, [&](std::size_t tet, std::size_t /*corner*/) {
          const double share = volumes_[tet] / 20;
          for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += share * own[k];
          for (const std::uint32_t other : mesh_.tets[tet]) {
            const auto row = x.row(other);
            for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += share * row[k];
          }
        });
      },
      kRowsPerRun);
}

/// Squares of very large numbers, and of very small ones, are none that a double has. So
/// columns are solved at a size of about one, with the same bits.
void MassMatrix::solve(const Table& right, Table& x, const Cancellation& cancellation) const {
  const std::vector<int> exponents = exponents_of(right);
  Table residual = right;
  scale_columns(residual, exponents, -1);
  scale_columns(x, exponents, -1);
  solve_scaled(residual, x, cancellation);
  scale_columns(x, exponents, 1);
}

/// The residual begins as the right side.
void MassMatrix::solve_scaled(Table& residual,
                              Table& x,
                              const Cancellation& cancellation) const {
  constexpr int kMostSteps = 200;
  constexpr double kExact = 1e-28;  // of the squared residual
  const std::size_t width = residual.width;
  Table product{width, std::vector<double>(residual.values.size())};
  // The diagonal is two fifths of the weights: as good a preconditioner as they are.
  const auto scaled = [&](double value, std::size_t i) {
    return weights_[i] > 0 ? value / weights_[i] : 0;
  };
  const auto squares_of = [&](const Table& table) {
    return sum_rows(table.rows(), width, [&](std::size_t i, std::size_t k) {
      return table.row(i)[k] * scaled(table.row(i)[k], i);
    });
  };
  const std::vector<double> goal = squares_of(residual);
  multiply(x, product);
  update_rows(residual,
              [&](double& value, std::size_t i, std::size_t k) { value -= product.row(i)[k]; });
  Table step = residual;
  update_rows(step,
              [&](double& value, std::size_t i, std::size_t) { value = scaled(value, i); });
  std::vector<double> squares = squares_of(residual);
  for (int s = 0; s < kMostSteps && !cancellation.requested(); ++s) {
    bool done = true;
    for (std::size_t k = 0; k < width; ++k) done = done && squares[k] <= kExact * goal[k];
    if (done) return;
    multiply(step, product);
    const std::vector<double> curve = dot(step, product);
    std::vector<double> length(width), again(width);
    for (std::size_t k = 0; k < width; ++k) {
      length[k] = curve[k] > 0 ? squares[k] / curve[k] : 0;
    }
    update_rows(x, [&](double& value, std::size_t i, std::size_t k) {
      value += length[k] * step.row(i)[k];
    });
    update_rows(residual, [&](double& value, std::size_t i, std::size_t k) {
      value -= length[k] * product.row(i)[k];
    });
    const std::vector<double> next = squares_of(residual);
    for (std::size_t k = 0; k < width; ++k)
      again[k] = squares[k] > 0 ? next[k] / squares[k] : 0;
    squares = next;
    update_rows(step, [&](double& value, std::size_t i, std::size_t k) {
      value = scaled(residual.row(i)[k], i) + again[k] * value;
    });
  }
}

}  // namespace tet
