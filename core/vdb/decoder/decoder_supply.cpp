#include "core/vdb/decoder/decoder_supply.h"

#include <utility>

namespace tet {

void DecoderSupply::prepare(const Cancelled& cancelled) {
  if (ready_) return;
  if (absl::StatusOr<Decoder> made = make(cancelled); made.ok())
    ready_.emplace(*std::move(made));
}

absl::StatusOr<Decoder> DecoderSupply::take(const Cancelled& cancelled) {
  if (!ready_) return make(cancelled);
  Decoder taken = *std::move(ready_);
  ready_.reset();
  return taken;
}

void DecoderSupply::start_anew() {
  original_.reset();
  ready_.reset();
}

absl::Status DecoderSupply::start(const Cancelled& cancelled) {
  absl::StatusOr<Decoder> started = Decoder::start(program_);
  if (!started.ok()) return started.status();
  absl::Status ready = started->wait_until_ready(cancelled);
  if (ready.ok()) original_.emplace(*std::move(started));
  return ready;
}

/// The original may have been killed since the last copy: then there is another one.
absl::StatusOr<Decoder> DecoderSupply::make(const Cancelled& cancelled) {
  if (original_) {
    absl::StatusOr<Decoder> copy = original_->copy(cancelled);
    if (!absl::IsUnavailable(copy.status())) return copy;
    original_.reset();
  }
  if (absl::Status started = start(cancelled); !started.ok()) return started;
  return original_->copy(cancelled);
}

}  // namespace tet
