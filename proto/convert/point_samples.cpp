#include "proto/convert/point_samples.h"

#include <bit>
#include <cstring>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/status.h"
#include "proto/wire/checksum.h"

namespace tet {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(WorldPoint) == 3 * sizeof(double));

template <class Number>
std::string_view bytes_of(std::span<const Number> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

/// Copies a column, whose bytes may lie at any address.
template <class Number>
absl::Status copy_column(const char* name, const std::string& bytes, std::span<Number> to) {
  if (bytes.size() != to.size_bytes()) {
    return absl::InvalidArgumentError(absl::StrFormat("%s has %d bytes, and its points need %d",
                                                      name, bytes.size(), to.size_bytes()));
  }
  if (!bytes.empty()) std::memcpy(to.data(), bytes.data(), bytes.size());
  return absl::OkStatus();
}

}  // namespace

void to_proto(std::span<const WorldPoint> points, v1::PointBatch& message) {
  const std::string_view bytes = bytes_of(points);
  message.set_positions(bytes.data(), bytes.size());
}

absl::StatusOr<std::vector<WorldPoint>> from_proto(const v1::PointBatch& message,
                                                   std::uint64_t first) {
  const std::string& bytes = message.positions();
  if (bytes.size() % sizeof(WorldPoint) != 0) {
    return invalid_field(absl::StrFormat("positions has %d bytes; a point has %d", bytes.size(),
                                         sizeof(WorldPoint)));
  }
  std::vector<WorldPoint> points(bytes.size() / sizeof(WorldPoint));
  if (!bytes.empty()) std::memcpy(points.data(), bytes.data(), bytes.size());
  if (auto status = check_points(points, first); !status.ok()) {
    return invalid_field(absl::StrCat("positions: ", status.message()));
  }
  return points;
}

void to_proto(const SampleColumns& columns, std::uint64_t first, v1::PointSamples& message) {
  const std::string_view phi = bytes_of(std::span<const double>(columns.phi));
  const std::string_view slopes = bytes_of(std::span<const double>(columns.slopes));
  const std::string_view fields = bytes_of(std::span<const float>(columns.fields));
  message.set_first_point(static_cast<std::int64_t>(first));
  message.set_point_count(static_cast<std::int64_t>(columns.phi.size()));
  message.set_checksum(chunk_checksum({phi, slopes, fields}));
  message.set_phi(phi.data(), phi.size());
  message.set_slopes(slopes.data(), slopes.size());
  message.set_fields(fields.data(), fields.size());
}

absl::Status copy_samples(const v1::PointSamples& message, const SampleColumns& columns) {
  absl::Status status = copy_column("phi", message.phi(), columns.phi);
  if (status.ok()) status = copy_column("slopes", message.slopes(), columns.slopes);
  if (status.ok()) status = copy_column("fields", message.fields(), columns.fields);
  if (!status.ok()) return status;
  const std::uint32_t sum = chunk_checksum({message.phi(), message.slopes(), message.fields()});
  if (sum == message.checksum()) return absl::OkStatus();
  return absl::InvalidArgumentError("the samples have a wrong checksum");
}

}  // namespace tet
