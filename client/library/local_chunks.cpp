#include "client/library/local_chunks.h"

#include <algorithm>
#include <new>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/failure_name.h"
#include "core/fidelity/measure_plan.h"

namespace tet {

namespace {

/// Enough that no thread waits long for the slowest of its batch.
constexpr std::size_t kChunksAThread = 4;

}  // namespace

LocalChunks::LocalChunks(LocalWork work, const Cancellation& cancellation)
    : work_(std::move(work)), cancellation_(cancellation), pool_(work_.threads) {}

absl::StatusOr<const MeshHeader*> LocalChunks::header() {
  if (failure_.ok() && plan_ == nullptr) failure_ = plan();
  if (!failure_.ok()) return failure_;
  return &plan_->header();
}

absl::Status LocalChunks::plan() {
  absl::StatusOr<std::shared_ptr<const MeshPlan>> planned = absl::UnknownError("not started");
  pool_.run([&] {
    planned =
        plan_mesh({.shape = std::move(work_.shape), .request = work_.request}, cancellation_);
  });
  if (!planned.ok()) return planned.status();
  plan_ = *std::move(planned);
  const std::uint64_t count = plan_->header().chunk_count;
  next_ = batch_end_ = work_.range.first;
  end_ = work_.range.end.value_or(count);
  if (next_ <= end_ && end_ <= count) return absl::OkStatus();
  return named_failure(
      "CHUNK_RANGE", absl::OutOfRangeError(absl::StrCat("chunks ", next_, " to ", end_,
                                                        " are not among the mesh's ", count)));
}

absl::StatusOr<const ChunkView*> LocalChunks::next() {
  if (const auto counted = header(); !counted.ok()) return counted.status();
  if (next_ == end_) failure_ = finish();
  if (!failure_.ok()) return failure_;
  if (next_ == end_) return nullptr;
  if (next_ == batch_end_) failure_ = make_batch();
  if (!failure_.ok()) return failure_;
  const Made& made = batch_[next_ - batch_begin_];
  quality_.add(made.quality);
  chunk_ = {next_, plan_->chunk(next_), std::as_const(made.columns.mesh()).columns()};
  ++next_;
  if (work_.progress) {
    const std::uint64_t begin = work_.range.first;
    work_.progress(static_cast<double>(next_ - begin) / static_cast<double>(end_ - begin));
  }
  return &chunk_;
}

std::shared_ptr<const TetMesh> LocalChunks::keep() const {
  return next_ > batch_begin_ && next_ <= batch_begin_ + batch_.size()
             ? batch_[next_ - 1 - batch_begin_].columns.kept()
             : nullptr;
}

absl::Status LocalChunks::make_batch() try {
  const std::uint64_t left = end_ - next_;
  const auto size = static_cast<std::size_t>(pool_.threads()) * kChunksAThread;
  batch_.resize(std::min<std::uint64_t>(left, size));
  batch_begin_ = next_;
  pool_.run([&] {
    for_each_index(batch_.size(), [&](std::size_t i) {
      if (!cancellation_.requested()) make(next_ + i, batch_[i]);
    });
  });
  batch_end_ = next_ + batch_.size();
  return check_cancelled(cancellation_);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("no memory for the next chunks");
}

void LocalChunks::make(std::uint64_t index, Made& made) const {
  const ChunkExtent place = plan_->chunk(index);
  TetMesh& mesh = made.columns.make(header_of_chunk(plan_->header(), place));
  made.quality = plan_->fill_chunk(index, made.workspace, mesh.columns());
}

absl::Status LocalChunks::finish() {
  batch_.clear();
  // Facts are told of whole meshes, once.
  if (end_ - work_.range.first < plan_->header().chunk_count || finished_) {
    return absl::OkStatus();
  }
  finished_ = true;
  facts_.boundary = plan_->boundary();
  facts_.improvement = plan_->improvement();
  facts_.thin_walls = plan_->thin_walls();
  if (plan_->statistics() == Statistics::kMeasured) facts_.quality = quality_;
  if (!work_.request.fidelity) return absl::OkStatus();
  absl::StatusOr<MeshFidelity> fidelity = absl::UnknownError("not started");
  pool_.run([&] { fidelity = fidelity_of(*plan_, work_.request, cancellation_); });
  if (!fidelity.ok()) return fidelity.status();
  facts_.fidelity = *std::move(fidelity);
  return absl::OkStatus();
}

}  // namespace tet
