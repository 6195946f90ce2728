#include "core/files/block_writer.h"

namespace tet {

BlockWriter::BlockWriter(AtomicFile& file,
                         std::uint64_t total_bytes,
                         const WriteControl& control)
    : file_(file),
      total_bytes_(total_bytes),
      control_(control),
      blocks_(std::make_shared<ScratchPool<Block>>()) {}

BlockWriter::BlockWriter(const BlockWriter& writer, Another)
    : file_(writer.file_),
      position_(writer.position_),
      total_bytes_(writer.total_bytes_),
      control_(writer.control_),
      tells_progress_(false),
      blocks_(writer.blocks_) {}

void BlockWriter::bytes(std::span<const std::byte> column) {
  while (!column.empty() && status_.ok()) {
    const std::size_t size = std::min(column.size(), kBlockBytes);
    write_block(column.first(size));
    column = column.subspan(size);
  }
}

void BlockWriter::write_block(std::span<const std::byte> block, std::uint64_t progress_bytes) {
  if (!goes_on()) return;
  status_ = file_.write_at(position_, block);
  position_ += block.size();
  tell_progress(progress_bytes);
}

bool BlockWriter::is_cancelled() {
  if (control_.cancellation == nullptr || !control_.cancellation->requested()) return false;
  status_ = absl::CancelledError("stopped while writing the mesh");
  return true;
}

void BlockWriter::tell_progress(std::uint64_t bytes) {
  written_bytes_ += bytes;
  if (!tells_progress_ || !control_.progress || total_bytes_ == 0) return;
  control_.progress(static_cast<double>(written_bytes_) / static_cast<double>(total_bytes_));
}

}  // namespace tet
