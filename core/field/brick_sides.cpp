#include "core/field/brick_sides.h"

#include "core/base/brick_mask.h"
#include "core/base/sse.h"

namespace tet {
namespace {

using Slices = std::array<std::uint64_t, kBrickParts.size()>;

/// The bits of a slice that lie in part `y` and part `z` of it, at 3*y + z.
constexpr auto kSliceParts = [] {
  std::array<std::uint64_t, 9> parts{};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto [first_y, rows] = kBrickParts[i / 3];
    const auto [first_z, count] = kBrickParts[i % 3];
    for (std::size_t y = first_y; y < first_y + rows; ++y) {
      parts[i] |= ((std::uint64_t{1} << count) - 1) << (8 * y + first_z);
    }
  }
  return parts;
}();

/// Which of a brick's values lie inside.
BrickMask mask_inside(const InsideTestOfValue& inside, const float* values) noexcept {
  const __m128 sign = _mm_set1_ps(inside.above ? -1.0F : 1.0F);
  const __m128 bar = _mm_set1_ps(inside.above ? -inside.iso : inside.iso);
  const auto four = [&](const float* from) {
    return _mm_castps_si128(_mm_cmplt_ps(_mm_mul_ps(sign, _mm_loadu_ps(from)), bar));
  };
  BrickMask mask;
  for (std::size_t i = 0; i < std::size_t{kBrickCells}; i += 16) {
    const float* const at = values + i;
    const __m128i bytes = _mm_packs_epi16(_mm_packs_epi32(four(at), four(at + 4)),
                                          _mm_packs_epi32(four(at + 8), four(at + 12)));
    const auto bits = static_cast<unsigned>(_mm_movemask_epi8(bytes));
    mask.slice[i / 64] |= std::uint64_t{bits} << (i % 64);
  }
  return mask;
}

/// What the slices in each part along x have in any of them.
Slices slices_by_part(const BrickMask& mask) noexcept {
  Slices slices{};
  for (std::size_t part = 0; part < slices.size(); ++part) {
    const auto [first, count] = kBrickParts[part];
    for (std::size_t x = first; x < first + count; ++x) slices[part] |= mask.slice[x];
  }
  return slices;
}

/// The parts that have some of these, 9*x + 3*y + z.
std::uint64_t parts_with(const BrickMask& mask) noexcept {
  const Slices slices = slices_by_part(mask);
  std::uint64_t parts = 0;
  for (std::size_t x = 0; x < slices.size(); ++x) {
    for (std::size_t i = 0; i < kSliceParts.size(); ++i) {
      parts |= std::uint64_t{(slices[x] & kSliceParts[i]) != 0} << (9 * x + i);
    }
  }
  return parts;
}

}  // namespace

std::uint64_t find_sides(const InsideTestOfValue& inside, const float* values) noexcept {
  const BrickMask mask = mask_inside(inside, values);
  return parts_with(mask) | parts_with(~mask) << 27;
}

std::uint64_t BrickSides::look_at(std::size_t brick) noexcept {
  const std::uint64_t parts =
      find_sides(InsideTestOfValue(field_), field_.volume->values.data() + brick * kBrickCells);
  parts_[brick].store(parts, std::memory_order_relaxed);
  return parts;
}

}  // namespace tet
