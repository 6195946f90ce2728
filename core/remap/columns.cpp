#include "core/remap/columns.h"

#include <algorithm>

namespace tet {

Table table_of(const std::vector<const DataArray*>& arrays) {
  Table table;
  for (const DataArray* array : arrays) table.width += array->components;
  if (arrays.empty()) return table;
  const std::size_t rows = arrays.front()->rows();
  table.values.resize(rows * table.width);
  std::size_t column = 0;
  for (const DataArray* array : arrays) {
    for (std::size_t i = 0; i < rows; ++i) {
      std::copy_n(array->values.begin() + static_cast<std::ptrdiff_t>(i * array->components),
                  array->components,
                  table.row(i).begin() + static_cast<std::ptrdiff_t>(column));
    }
    column += array->components;
  }
  return table;
}

std::vector<DataArray> arrays_of(const Table& table,
                                 const std::vector<const DataArray*>& like,
                                 bool keep_types) {
  std::vector<DataArray> arrays;
  std::size_t column = 0;
  for (const DataArray* each : like) {
    DataArray array{.name = each->name, .components = each->components, .values = {}};
    if (keep_types) array.type = each->type;
    array.values.resize(table.rows() * each->components);
    for (std::size_t i = 0; i < table.rows(); ++i) {
      std::copy_n(table.row(i).begin() + static_cast<std::ptrdiff_t>(column), each->components,
                  array.values.begin() + static_cast<std::ptrdiff_t>(i * each->components));
    }
    column += each->components;
    arrays.push_back(std::move(array));
  }
  return arrays;
}

}  // namespace tet
