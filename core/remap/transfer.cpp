#include "core/remap/transfer.h"

#include <algorithm>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>

#include "core/remap/conservative_transfer.h"
#include "core/remap/linear_transfer.h"

namespace tet {
namespace {

using Chosen = std::vector<const DataArray*>;

struct ChosenArrays {
  Chosen points, cells;
};

std::vector<std::string> names_of(const DataMesh& mesh) {
  std::vector<std::string> names;
  for (const auto* arrays : {&mesh.point_data, &mesh.cell_data}) {
    for (const DataArray& array : *arrays) names.push_back(array.name);
  }
  return names;
}

absl::StatusOr<ChosenArrays> choose(const DataMesh& from,
                                    const std::vector<std::string>& wanted) {
  const std::vector<std::string> names = names_of(from);
  for (const std::string& name : wanted) {
    if (std::ranges::find(names, name) != names.end()) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("the old mesh has no array \"", name,
                     "\"; it has: ", names.empty() ? "none" : absl::StrJoin(names, ", ")));
  }
  ChosenArrays chosen;
  const auto take = [&](const std::vector<DataArray>& arrays, Chosen& into) {
    for (const DataArray& array : arrays) {
      const bool is_wanted =
          wanted.empty() || std::ranges::find(wanted, array.name) != wanted.end();
      if (is_wanted) into.push_back(&array);
    }
  };
  take(from.point_data, chosen.points);
  take(from.cell_data, chosen.cells);
  if (chosen.points.empty() && chosen.cells.empty()) {
    return absl::InvalidArgumentError("the old mesh has no arrays");
  }
  return chosen;
}

std::vector<WorldPoint> middles_of_cells(const DataMesh& mesh) {
  std::vector<WorldPoint> middles(mesh.tets.size());
  for (std::size_t i = 0; i < middles.size(); ++i) {
    for (const WorldPoint& p : mesh.places(i)) {
      WorldPoint& m = middles[i];
      m = {m.x + p.x / 4, m.y + p.y / 4, m.z + p.z / 4};
    }
  }
  return middles;
}

/// Notes which points of the new mesh lie outside.
void tell_outside(const Outside& points, const Outside& cells, TransferResult& result) {
  result.outside_points = points.points;
  result.outside_cells = cells.points;
  result.farthest = std::max(points.farthest, cells.farthest);
}

MeshTables transfer_linearly(const TetLocator& locator,
                             const MeshTables& old_tables,
                             const DataMesh& to,
                             bool clamp,
                             const Cancellation& cancellation,
                             TransferResult& result) {
  MeshTables tables;
  Outside points, cells;
  if (old_tables.points.width > 0) {
    tables.points =
        sample_at_points(locator, old_tables.points, to.points, clamp, cancellation, points);
  }
  if (old_tables.cells.width > 0) {
    tables.cells =
        sample_cells(locator, old_tables.cells, middles_of_cells(to), cancellation, cells);
  }
  tell_outside(points, cells, result);
  return tables;
}

/// Integrals of each array's first component.
void tell_integrals(const Chosen& chosen,
                    bool at_points,
                    const std::vector<double>& before,
                    const std::vector<double>& after,
                    TransferResult& result) {
  std::size_t column = 0;
  for (const DataArray* array : chosen) {
    result.told.push_back({array->name, at_points, before[column], after[column]});
    column += array->components;
  }
}

}  // namespace

absl::StatusOr<TransferResult> transfer(const DataMesh& from,
                                        const DataMesh& to,
                                        const TransferOptions& options,
                                        const Cancellation& cancellation) {
  if (from.tets.empty()) return absl::InvalidArgumentError("the old mesh has no tets");
  if (to.tets.empty()) return absl::InvalidArgumentError("the new mesh has no tets");
  const absl::StatusOr<ChosenArrays> chosen = choose(from, options.arrays);
  if (!chosen.ok()) return chosen.status();
  const MeshTables old_tables{table_of(chosen->points), table_of(chosen->cells)};
  const TetLocator locator(from);
  TransferResult result;
  MeshTables tables;
  const bool conserves = options.mode == TransferMode::kConservative;
  if (conserves) {
    ConservativeResult made =
        transfer_integrals(locator, old_tables, to, options.clamp, cancellation);
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
    if (!(made.common_volume > 0)) {
      return absl::InvalidArgumentError(
          "the meshes have no volume in common, so there is nothing to conserve: are both in "
          "the same units and place?");
    }
    tables = std::move(made.tables);
  } else {
    tables = transfer_linearly(locator, old_tables, to, options.clamp, cancellation, result);
  }
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;

  const MassMatrix before(from), after(to);
  tell_integrals(chosen->points, true, integrals_of_points(before, old_tables.points),
                 integrals_of_points(after, tables.points), result);
  tell_integrals(chosen->cells, false, integrals_of_cells(before, old_tables.cells),
                 integrals_of_cells(after, tables.cells), result);
  result.point_data = arrays_of(tables.points, chosen->points, false);
  result.cell_data = arrays_of(tables.cells, chosen->cells, !conserves);
  return result;
}

}  // namespace tet
