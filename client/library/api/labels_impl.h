// What public labels hold.
#pragma once

#include <memory>

#include "core/plan/shape.h"
#include "core/volume/label_volume.h"
#include "tetstream/labels.h"

namespace tetstream {

struct Labels::Impl {
  std::shared_ptr<const tet::LabelVolume> volume;  ///< null where there are level sets
  tet::GridList level_sets = {};
};

}  // namespace tetstream
