// What public labels hold.
#pragma once

#include <memory>

#include "core/volume/label_volume.h"
#include "tetstream/labels.h"

namespace tetstream {

struct Labels::Impl {
  std::shared_ptr<const tet::LabelVolume> volume;  ///< not null
};

}  // namespace tetstream
