#include "core/plan/sample_fields.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "core/base/check.h"
#include "core/volume/point_sampler.h"

namespace tet {
namespace {

constexpr std::size_t kBatch = PointSampler::kMaxPoints;

using Points = PointSampler::Points;

/// Where vertices [first, first + points.count) lie in the world.
template <class Number>
void find_places(const MeshHeader& header,
                 std::span<const std::byte> positions,
                 std::size_t first,
                 Points& points) noexcept {
  const std::byte* row = positions.data() + first * 3 * sizeof(Number);
  const auto [x, y, z] = header.origin;
  for (std::size_t i = 0; i < points.count; ++i, row += 3 * sizeof(Number)) {
    std::array<Number, 3> at;
    std::memcpy(at.data(), row, sizeof(at));
    points.at[0][i] = x + at[0];
    points.at[1][i] = y + at[1];
    points.at[2][i] = z + at[2];
  }
}

void find_places(const MeshHeader& header,
                 std::span<const std::byte> positions,
                 std::size_t first,
                 Points& points) noexcept {
  if (header.coordinate_type == CoordinateType::kFloat64) {
    find_places<double>(header, positions, first, points);
  } else {
    find_places<float>(header, positions, first, points);
  }
}

std::vector<PointSampler> samplers_of(std::span<const VertexField> fields) {
  std::vector<PointSampler> samplers;
  for (const VertexField& field : fields) samplers.emplace_back(field.components);
  return samplers;
}

}  // namespace

void sample_fields(std::span<const VertexField> fields,
                   const MeshHeader& header,
                   std::span<const std::byte> positions,
                   std::span<std::byte> values) noexcept {
  const std::size_t stride = header.field_values();
  const std::size_t vertices = values.size() / (stride * sizeof(float));
  std::vector<PointSampler> samplers = samplers_of(fields);
  std::vector<float> rows(kBatch * stride);
  const auto workspace = std::make_unique_for_overwrite<PointSampler::Workspace>();
  Points points;
  for (std::size_t first = 0; first < vertices; first += kBatch) {
    points.count = std::min(kBatch, vertices - first);
    find_places(header, positions, first, points);
    float* column = rows.data();
    for (PointSampler& sampler : samplers) {
      sampler.sample(points, *workspace, column, stride);
      column += sampler.components();
    }
    // Whose values may lie at any address.
    const std::size_t row_bytes = stride * sizeof(float);
    std::memcpy(values.data() + first * row_bytes, rows.data(), points.count * row_bytes);
  }
}

void write_cut_faces(std::span<const std::uint8_t> faces,
                     const MeshHeader& header,
                     std::span<std::byte> values) noexcept {
  const std::size_t row_bytes = header.field_values() * sizeof(float);
  std::byte* end_of_row = values.data();
  for (const std::uint8_t vertex : faces) {
    end_of_row += row_bytes;
    const auto number = static_cast<float>(vertex);
    std::memcpy(end_of_row - sizeof(number), &number, sizeof(number));
  }
}

}  // namespace tet
