// A surface as a level set, with what was found on the way.
#pragma once

#include "core/vdb/plain/conversion_report.h"
#include "core/volume/volume.h"

namespace tet {

struct SurfaceVolume {
  Volume volume;
  ConversionReport report;
};

}  // namespace tet
