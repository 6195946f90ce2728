// Numbers of text headers, and the geometry that all formats have: checked as they are read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec3.h"
#include "core/image/image_outline.h"

namespace tet {

/// A stream of deflate makes at most this of a byte.
inline constexpr std::uint64_t kMostExpansion = 1032;

/// Words between white space; at most `most` of them, or it is refused. `what` names the field.
std::vector<std::string_view> words_of(std::string_view text,
                                       std::size_t most,
                                       const char* what);

/// The whole of `text` as a finite number, or as an integer.
double number_of(std::string_view text, const char* what);
std::int64_t integer_of(std::string_view text, const char* what);

/// Exactly three numbers.
Triple triple_of(std::string_view text, const char* what);

/// Sets the voxels along the axes of an array whose type is known. Axes beyond the third may
/// have one entry only: an image of more is refused with what to do.
void set_size(const std::vector<std::int64_t>& sizes, ImageArray& array);

/// Sets the map from voxels to the world: `axes[i]` is one step along axis i.
void set_axes(const std::array<Triple, 3>& axes, const Triple& origin, ImageArray& array);

/// Refuses more values than the data's bytes can hold, as they are encoded: what a small file
/// claims is never allocated.
void check_claim(const ImageArray& array);

/// Refuses data that ends beyond the file.
void check_data_end(const ImageArray& array, std::uint64_t file_bytes);

/// Sets where an array's data lie that follow their header in one file, and checks them.
void set_attached_data(std::uint64_t header_end, std::uint64_t file_bytes, ImageArray& array);

}  // namespace tet
