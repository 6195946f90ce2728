// What only OpenVDB can do, as a part of tetstream that is loaded when something needs it.
//
// Finding the symbols of OpenVDB's library takes 35 ms of a processor, which whoever reads an
// ordinary grid, or talks to a server, need not spend.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"
#include "core/vdb/openvdb/surface_volume.h"
#include "core/vdb/plain/conversion_report.h"
#include "core/vdb/plain/load_limits.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// Functions of load.h, surface_to_volume.h and write_volume.h.
struct OpenVdbPart {
  absl::StatusOr<std::vector<GridInfo>> (*list_grids)(const OpenGridFile&, const LoadLimits&);
  absl::StatusOr<Volume> (*load_volume)(const OpenGridFile&,
                                        const std::string&,
                                        const LoadLimits&);
  absl::StatusOr<Volume> (*load_field)(const OpenGridFile&,
                                       const std::string&,
                                       std::uint32_t,
                                       const LoadLimits&);
  absl::StatusOr<LabelVolume> (*load_labels)(const OpenGridFile&,
                                             const std::string&,
                                             const LoadLimits&);
  absl::StatusOr<SurfaceVolume> (*surface_to_volume)(const TriangleSurface&,
                                                     double,
                                                     OpenSurface);
  absl::StatusOr<ConversionReport> (*surface_to_vdb)(const TriangleSurface&,
                                                     double,
                                                     const std::string&,
                                                     OpenSurface);
  absl::Status (*write_volume)(const Volume&, const std::string&);
  /// Does what OpenVDB and the threading library do once in a process, for a process that will
  /// stay in one thread.
  void (*prepare_for_sandbox)();
};

/// Loads the part, the first time. Thread-safe. Errors: kUnavailable (it is not installed; says
/// where it was looked for).
absl::StatusOr<const OpenVdbPart*> openvdb_part();

/// Whether it has been loaded.
bool has_openvdb_part() noexcept;

/// Calls `use(part)`, or returns why there is none.
template <class Use>
auto with_openvdb(const Use& use) -> decltype(use(std::declval<const OpenVdbPart&>())) {
  const absl::StatusOr<const OpenVdbPart*> part = openvdb_part();
  if (!part.ok()) return part.status();
  return use(**part);
}

}  // namespace tet
