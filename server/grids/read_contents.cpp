#include "server/grids/read_contents.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "core/vdb/decoder/decode_file.h"
#include "server/ops/guard.h"

namespace tet {
namespace {

/// Reads grid after grid; kept by the decoders' callbacks alone.
class ContentsReader : public std::enable_shared_from_this<ContentsReader> {
 public:
  ContentsReader(DecoderPool& decoders,
                 ContentsOrder order,
                 std::function<bool()> cancelled,
                 ContentsRead done)
      : decoders_(decoders),
        order_(std::move(order)),
        cancelled_(std::move(cancelled)),
        done_(std::move(done)),
        contents_(order_.grids.size()) {}

  void read_next() {
    while (grid_ < contents_.size() && !order_.grids[grid_].not_meshable.empty()) ++grid_;
    if (grid_ == contents_.size() || read_ == kMostGridsRead)
      return done_(std::move(contents_));
    decode(DecodeTask::kValues, [this](absl::StatusOr<GridContents> told) {
      if (absl::IsFailedPrecondition(told.status())) {
        contents_[grid_].not_meshable = std::string(told.status().message());
        return next_grid();
      }
      if (!told.ok()) return done_(told.status());
      contents_[grid_] = *std::move(told);
      if (!may_have_labels(order_.grids[grid_])) return next_grid();
      read_labels();
    });
  }

 private:
  void read_labels() {
    decode(DecodeTask::kLabelCounts, [this](absl::StatusOr<GridContents> told) {
      // Where that is so it is no segmentation.
      if (absl::IsFailedPrecondition(told.status())) return next_grid();
      if (!told.ok()) return done_(told.status());
      contents_[grid_].label_count = told->label_count;
      contents_[grid_].labels = std::move(told->labels);
      next_grid();
    });
  }

  void next_grid() {
    ++grid_;
    ++read_;
    read_next();
  }

  template <class Then>
  void decode(DecodeTask task, const Then& then) {
    const FileRequest request{task, order_.path, order_.file_name, order_.grids[grid_].name,
                              order_.max_bytes};
    decoders_.decode(
        order_.client, request, cancelled_,
        [self = shared_from_this(), request, then](const absl::StatusOr<SealedBlock>& block) {
          const absl::Status status = guarded("reading a grid's values", [&] {
            then(contents_of(block, request));
            return absl::OkStatus();
          });
          if (!status.ok()) self->done_(status);
        });
  }

  DecoderPool& decoders_;
  const ContentsOrder order_;
  const std::function<bool()> cancelled_;
  const ContentsRead done_;
  std::vector<GridContents> contents_;
  std::size_t grid_ = 0, read_ = 0;
};

}  // namespace

void read_contents_of(DecoderPool& decoders,
                      ContentsOrder order,
                      std::function<bool()> cancelled,
                      ContentsRead done) {
  std::make_shared<ContentsReader>(decoders, std::move(order), std::move(cancelled),
                                   std::move(done))
      ->read_next();
}

}  // namespace tet
