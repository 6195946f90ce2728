#include "core/vdb/openvdb/openvdb_functions.h"

#include "core/base/parallel.h"
#include "core/vdb/openvdb/load.h"
#include "core/vdb/openvdb/surface_to_volume.h"
#include "core/vdb/openvdb/write_volume.h"

namespace tet {
namespace {

/// Prepares the threads of this part: a program that loads it has a pool of its own.
void prepare_for_sandbox() {
  stay_in_one_thread();
  prepare_loading();
  for_each_index(2, [](std::size_t) {});
}

}  // namespace

const OpenVdbPart& openvdb_functions() noexcept {
  static constexpr OpenVdbPart kFunctions{
      .list_grids = list_grids,
      .load_volume = load_volume,
      .load_field = load_field,
      .load_labels = load_labels,
      .surface_to_volume = surface_to_volume,
      .surface_to_vdb = surface_to_vdb,
      .write_volume = write_volume,
      .prepare_for_sandbox = prepare_for_sandbox,
  };
  return kFunctions;
}

}  // namespace tet
