#include "core/field/region_signs.h"

#include "core/base/parallel.h"

namespace tet {
namespace {

RegionSigns signs_of(const PhiField& field, const Region& region) noexcept {
  const InsideTestOfValue inside(field);
  const std::vector<ValueRange>& ranges = field.volume->ranges;
  RegionSigns signs;
  for (std::size_t row = 0; row < signs.inside.size(); ++row) {
    unsigned in = 0, out = 0;
    for (std::size_t z = 0; z < Region::kEdgeBricks; ++z) {
      const std::size_t at = row * Region::kEdgeBricks + z;
      const std::uint32_t brick = region.brick_index[at];
      const ValueRange range = brick == Region::kConstant
                                   ? ValueRange{region.constant[at], region.constant[at]}
                                   : ranges[brick];
      const bool min_inside = inside(range.min), max_inside = inside(range.max);
      in |= static_cast<unsigned>(min_inside || max_inside) << z;
      out |= static_cast<unsigned>(!min_inside || !max_inside) << z;
    }
    signs.inside[row] = static_cast<std::uint16_t>(in);
    signs.outside[row] = static_cast<std::uint16_t>(out);
  }
  return signs;
}

/// The bricks along one axis of the halo that lie in the region before (-1), itself (0) or the
/// one after (1).
struct Span {
  std::size_t first, last;
  explicit Span(int part) noexcept
      : first(part < 0 ? 0 : (part == 0 ? 1 : Region::kEdgeBricks + 1)),
        last(part == 0 ? Region::kEdgeBricks : first) {}
};

/// Place in its region of the brick at `i` of the halo.
std::size_t within_region(std::size_t i) noexcept {
  return (i + Region::kEdgeBricks - 1) % Region::kEdgeBricks;
}

/// A region's row as bits of the halo's row.
std::uint32_t halo_bits(std::uint16_t row, int part) noexcept {
  if (part < 0) return row >> (Region::kEdgeBricks - 1);
  return part == 0 ? std::uint32_t{row} << 1 : (row & 1U) << (Region::kEdgeBricks + 1);
}

BrickCoord part_of(std::size_t i) noexcept {
  const auto n = static_cast<std::int32_t>(i);
  return {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
}

}  // namespace

RegionSigns RegionSigns::of_constant(bool is_inside) noexcept {
  RegionSigns signs;
  (is_inside ? signs.inside : signs.outside).fill(0xffff);
  return signs;
}

std::vector<RegionSigns> signs_of_regions(const PhiField& field) {
  const std::vector<Region>& regions = field.volume->regions;
  std::vector<RegionSigns> signs(regions.size());
  for_each_index(regions.size(),
                 [&](std::size_t i) { signs[i] = signs_of(field, regions[i]); });
  return signs;
}

SignsAround::SignsAround(const PhiField& field, const std::vector<RegionSigns>& of_regions)
    : field_(field), of_regions_(of_regions), reader_(*field.volume) {}

void SignsAround::enter(BrickCoord min) noexcept {
  any_region_ = inside_ = outside_ = false;
  const InsideTestOfValue inside(field_);
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const BrickCoord part = part_of(i);
    const VolumeReader::RegionOrConstant found = reader_.region(
        {min.x + Region::kEdgeBricks * part.x, min.y + Region::kEdgeBricks * part.y,
         min.z + Region::kEdgeBricks * part.z});
    if (found.region != nullptr) {
      any_region_ = true;
      around_[i] =
          &of_regions_[static_cast<std::size_t>(found.region - field_.volume->regions.data())];
      continue;
    }
    const bool is_inside = inside(found.constant);
    (is_inside ? inside_ : outside_) = true;
    around_[i] = is_inside ? &all_inside_ : &all_outside_;
  }
  inside_rows_ = around_[13]->inside;
}

void SignsAround::add(const RegionSigns& signs, BrickCoord part) noexcept {
  const Span along_x(part.x), along_y(part.y);
  for (std::size_t x = along_x.first; x <= along_x.last; ++x) {
    for (std::size_t y = along_y.first; y <= along_y.last; ++y) {
      const std::size_t row = within_region(x) * Region::kEdgeBricks + within_region(y);
      halo_inside_[x * kEdge + y] |= halo_bits(signs.inside[row], part.z);
      halo_outside_[x * kEdge + y] |= halo_bits(signs.outside[row], part.z);
    }
  }
}

void SignsAround::spread(HaloRows& rows) noexcept {
  for (std::uint32_t& row : rows) row |= row << 1 | row >> 1;
  for (const std::size_t step : {std::size_t{1}, kEdge}) {
    const HaloRows before = rows;
    for (std::size_t i = step; i + step < rows.size(); ++i) {
      rows[i] = before[i - step] | before[i] | before[i + step];
    }
  }
}

RegionRows SignsAround::near_surface() noexcept {
  halo_inside_ = {};
  halo_outside_ = {};
  for (std::size_t i = 0; i < around_.size(); ++i) add(*around_[i], part_of(i));
  spread(halo_inside_);
  spread(halo_outside_);
  RegionRows near;
  for (std::size_t row = 0; row < near.size(); ++row) {
    const std::size_t at =
        (row / Region::kEdgeBricks + 1) * kEdge + row % Region::kEdgeBricks + 1;
    near[row] = static_cast<std::uint16_t>((halo_inside_[at] & halo_outside_[at]) >> 1);
  }
  return near;
}

}  // namespace tet
