#include "proto/convert/mesh_parts.h"

#include <cmath>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/volume/volume.h"
#include "proto/convert/counts.h"

namespace tet {
namespace {

using RunMessages = google::protobuf::RepeatedPtrField<v1::KeptRun>;

void add_runs(const std::vector<KeptRun>& runs, RunMessages& messages) {
  for (const KeptRun& run : runs) {
    v1::KeptRun& added = *messages.Add();
    added.set_from(signed_count(run.from));
    added.set_to(signed_count(run.to));
    added.set_count(signed_count(run.count));
  }
}

absl::StatusOr<std::vector<KeptRun>> runs_of(const char* field, const RunMessages& messages) {
  std::vector<KeptRun> runs;
  for (const v1::KeptRun& run : messages) {
    if (!is_count(run.from()) || !is_count(run.to()) || !is_count(run.count())) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s[%d] has a number that is not from 0 to %d", field, runs.size(), kMaxCount));
    }
    runs.push_back(
        {unsigned_count(run.from()), unsigned_count(run.to()), unsigned_count(run.count())});
  }
  return runs;
}

using RunNumbers = google::protobuf::RepeatedField<std::uint64_t>;
constexpr int kNumbersOfRun = 3;

/// Three numbers a run, of which most are small.
void add_runs(const std::vector<KeptRun>& runs, RunNumbers& numbers) {
  numbers.Reserve(kNumbersOfRun * static_cast<int>(runs.size()));
  std::uint64_t from = 0, to = 0;
  for (const KeptRun& run : runs) {
    numbers.Add(run.from - from);
    numbers.Add(run.to - to);
    numbers.Add(run.count);
    from = run.from + run.count;
    to = run.to + run.count;
  }
}

absl::StatusOr<std::vector<KeptRun>> runs_of(const char* field, const RunNumbers& numbers) {
  if (numbers.size() % kNumbersOfRun != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s has %d numbers, which are no runs", field, numbers.size()));
  }
  std::vector<KeptRun> runs;
  runs.reserve(static_cast<std::size_t>(numbers.size() / kNumbersOfRun));
  std::uint64_t from = 0, to = 0;
  for (int i = 0; i < numbers.size(); i += kNumbersOfRun) {
    for (int k = i; k < i + kNumbersOfRun; ++k) {
      if (is_count(numbers[k])) continue;
      return absl::InvalidArgumentError(
          absl::StrFormat("%s[%d] is not from 0 to %d", field, k, kMaxCount));
    }
    const KeptRun run{from + numbers[i], to + numbers[i + 1], numbers[i + 2]};
    from = run.from + run.count;
    to = run.to + run.count;
    if (!is_count(from) || !is_count(to)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s[%d] ends a run beyond %d", field, i, kMaxCount));
    }
    runs.push_back(run);
  }
  return runs;
}

}  // namespace

void to_proto(const KeptParts& kept, v1::KeptParts& message) {
  message.set_loose(kept.loose);
  if (kept.loose) {
    add_runs(kept.vertices, *message.mutable_vertex_runs());
    add_runs(kept.tets, *message.mutable_tet_runs());
    return;
  }
  add_runs(kept.vertices, *message.mutable_vertices());
  add_runs(kept.tets, *message.mutable_tets());
}

void to_proto(const LatticeToWorld& to_world, v1::Lattice& message) {
  for (const auto& row : to_world.linear) {
    for (const double entry : row) message.add_linear(entry);
  }
  message.set_origin_x(to_world.origin.x);
  message.set_origin_y(to_world.origin.y);
  message.set_origin_z(to_world.origin.z);
}

absl::StatusOr<KeptParts> from_proto(const v1::KeptParts& message) {
  auto vertices = message.loose() ? runs_of("vertex_runs", message.vertex_runs())
                                  : runs_of("vertices", message.vertices());
  if (!vertices.ok()) return vertices.status();
  auto tets = message.loose() ? runs_of("tet_runs", message.tet_runs())
                              : runs_of("tets", message.tets());
  if (!tets.ok()) return tets.status();
  return KeptParts{*std::move(vertices), *std::move(tets), message.loose()};
}

absl::StatusOr<LatticeToWorld> from_proto(const v1::Lattice& message) {
  constexpr int kEntries = 9, kRow = 3;
  if (message.linear_size() != kEntries) {
    return absl::InvalidArgumentError(
        absl::StrFormat("linear has %d numbers, not %d", message.linear_size(), kEntries));
  }
  VoxelTransform transform;
  for (int i = 0; i < kEntries; ++i) {
    if (!std::isfinite(message.linear(i))) {
      return absl::InvalidArgumentError(absl::StrFormat("linear[%d] is not finite", i));
    }
    const auto row = static_cast<std::size_t>(i / kRow);
    const auto column = static_cast<std::size_t>(i % kRow);
    transform.linear[row][column] = message.linear(i);
  }
  return LatticeToWorld{transform.linear,
                        {message.origin_x(), message.origin_y(), message.origin_z()},
                        transform.mirrors()};
}

}  // namespace tet
