// A mesh with arrays of numbers at its points and cells, as files have them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// How a file stores an array's numbers.
enum class NumberType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
};

constexpr bool is_integer(NumberType type) noexcept { return type < NumberType::kFloat32; }

/// Rows of `components` numbers each; all are finite.
struct DataArray {
  std::string name;
  std::uint32_t components = 1;
  NumberType type = NumberType::kFloat64;
  std::vector<double> values;

  std::size_t rows() const noexcept { return values.size() / components; }
};

/// Arrays of a mesh as a whole, as names of its labels: nobody reads them here.
struct WholeArrays {
  std::string text;                        ///< those that a .vtu file has as text, as XML
  std::vector<std::string> left_out = {};  ///< names of those that it has otherwise
};

/// Tets of either orientation; every id is a point, every coordinate at most kMaxCoordinate.
struct DataMesh {
  static constexpr double kMaxCoordinate = 1e30;

  std::vector<WorldPoint> points;
  std::vector<std::array<std::uint32_t, 4>> tets;
  std::vector<DataArray> point_data, cell_data;
  WholeArrays of_whole;

  std::array<WorldPoint, 4> places(std::size_t tet) const noexcept {
    const auto& [a, b, c, d] = tets[tet];
    return {points[a], points[b], points[c], points[d]};
  }
};

}  // namespace tet
