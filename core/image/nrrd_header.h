// NRRD: https://teem.sourceforge.net/nrrd/format.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/image/image_outline.h"

namespace tet {

bool is_nrrd(std::span<const std::byte> head) noexcept;

/// Throws ImageRefusal; of a header whose data are in other files too.
ImageOutline read_nrrd_header(std::span<const std::byte> head, std::uint64_t file_bytes);

/// A header whose data are in other files, so as to join them.
struct DetachedHeader {
  std::vector<std::string> files;  ///< as the header names them, in their order
  std::string attached;            ///< the header of a file with all in it
  std::uint64_t skip_bytes = 0;    ///< at the beginning of each of the files
  bool skip_to_last = false;       ///< all of a file but the data's bytes at its end
  std::uint64_t data_bytes = 0;    ///< of all files together, where they are stored as they are
};
DetachedHeader read_detached_nrrd(std::span<const std::byte> head);
bool is_detached_nrrd(std::span<const std::byte> head);

}  // namespace tet
