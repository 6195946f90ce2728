// NIfTI-1 and NIfTI-2 in one file: https://nifti.nimh.nih.gov/nifti-1
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/image_outline.h"

namespace tet {

inline constexpr std::size_t kNiftiHeaderBytes = 540;  ///< of the longer one

/// Whether these are the first bytes of such a file, or of one with the data in another file.
bool is_nifti(std::span<const std::byte> head) noexcept;

/// `file_bytes` is the whole file's, unpacked. Throws ImageRefusal.
ImageOutline read_nifti_header(std::span<const std::byte> head, std::uint64_t file_bytes);

}  // namespace tet
