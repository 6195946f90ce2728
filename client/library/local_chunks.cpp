#include "client/library/local_chunks.h"

#include <algorithm>
#include <new>
#include <utility>

namespace tet {

namespace {

/// Enough that no thread waits long for the slowest of its batch.
constexpr std::size_t kChunksAThread = 4;

}  // namespace

LocalChunks::LocalChunks(Shape shape,
                         MeshRequest request,
                         int threads,
                         ProgressFunction progress,
                         const Cancellation& cancellation)
    : shape_(std::move(shape)),
      request_(std::move(request)),
      progress_(std::move(progress)),
      cancellation_(cancellation),
      pool_(threads) {}

absl::StatusOr<const MeshHeader*> LocalChunks::header() {
  if (failure_.ok() && plan_ == nullptr) failure_ = plan();
  if (!failure_.ok()) return failure_;
  return &plan_->header();
}

absl::Status LocalChunks::plan() {
  absl::StatusOr<std::shared_ptr<const MeshPlan>> planned = absl::UnknownError("not started");
  pool_.run([&] {
    planned = plan_mesh({.shape = std::move(shape_), .request = request_}, cancellation_);
  });
  if (!planned.ok()) return planned.status();
  plan_ = *std::move(planned);
  return absl::OkStatus();
}

absl::StatusOr<const ChunkView*> LocalChunks::next() {
  if (const auto counted = header(); !counted.ok()) return counted.status();
  if (next_ == plan_->header().chunk_count) return finish(), nullptr;
  if (next_ == batch_end_) failure_ = make_batch();
  if (!failure_.ok()) return failure_;
  const Made& made = batch_[next_ - batch_begin_];
  quality_.add(made.quality);
  chunk_ = {next_, plan_->chunk(next_), std::as_const(made.columns).columns()};
  ++next_;
  if (progress_) {
    progress_(static_cast<double>(next_) / static_cast<double>(plan_->header().chunk_count));
  }
  return &chunk_;
}

absl::Status LocalChunks::make_batch() try {
  const std::uint64_t left = plan_->header().chunk_count - next_;
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
  made.columns = TetMesh(header_of_chunk(plan_->header(), place), std::move(made.columns));
  made.quality = plan_->fill_chunk(index, made.workspace, made.columns.columns());
}

void LocalChunks::finish() {
  batch_.clear();
  facts_.boundary = plan_->boundary();
  facts_.improvement = plan_->improvement();
  facts_.thin_walls = plan_->thin_walls();
  if (plan_->statistics() == Statistics::kMeasured) facts_.quality = quality_;
}

}  // namespace tet
