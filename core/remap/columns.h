// Several arrays as the rows of one table, and what a row's numbers are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/remap/data_mesh.h"

namespace tet {

/// The numbers of some arrays side by side: those of one row lie together in memory.
struct Table {
  std::size_t width = 0;
  std::vector<double> values;

  std::span<double> row(std::size_t i) noexcept {
    return std::span(values).subspan(i * width, width);
  }
  std::span<const double> row(std::size_t i) const noexcept {
    return std::span(values).subspan(i * width, width);
  }
  std::size_t rows() const noexcept { return width == 0 ? 0 : values.size() / width; }
};

Table table_of(const std::vector<const DataArray*>& arrays);

/// The arrays again, named and with as many components as those they were made of.
std::vector<DataArray> arrays_of(const Table& table,
                                 const std::vector<const DataArray*>& like,
                                 bool keep_types);

}  // namespace tet
