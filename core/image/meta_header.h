// MetaImage: https://itk.org/Wiki/ITK/MetaIO/Documentation
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/image_outline.h"
#include "core/image/nrrd_header.h"

namespace tet {

bool is_meta(std::span<const std::byte> head) noexcept;

/// Throws ImageRefusal; of a header whose data are in other files too.
ImageOutline read_meta_header(std::span<const std::byte> head, std::uint64_t file_bytes);

bool is_detached_meta(std::span<const std::byte> head);
DetachedHeader read_detached_meta(std::span<const std::byte> head);

}  // namespace tet
