// VTK's image data in XML (.vti), in one piece:
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/image_outline.h"

namespace tet {

bool is_vti(std::span<const std::byte> head) noexcept;

/// Reads tags up to the appended data, or to the end of what is there: `head` may end before
/// the file does, and then only arrays whose data follow elsewhere are known. Throws
/// ImageRefusal.
ImageOutline read_vti_header(std::span<const std::byte> head, std::uint64_t file_bytes);

}  // namespace tet
