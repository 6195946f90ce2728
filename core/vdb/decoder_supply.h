// Decoders for one file after another, without starting the program for each.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <absl/status/statusor.h>

#include "core/vdb/decoder.h"

namespace tet {

/// Starts the program once and copies it for each file; the original never sees one.
///
/// Starting it takes some 40 ms of the processor, nearly all to find OpenVDB's symbols, and
/// copying it one. Not thread-safe: decoders end with the thread that asked for them.
class DecoderSupply {
 public:
  /// `cancelled` is polled while a decoder starts; null never cancels.
  DecoderSupply(DecoderProgram program, std::function<bool()> cancelled)
      : program_(std::move(program)), cancelled_(std::move(cancelled)) {}

  /// Has a decoder stand ready, where that is possible.
  void prepare();

  /// The one that stands ready, or a new one. Errors: kUnavailable; kCancelled.
  absl::StatusOr<Decoder> take();

  /// The next decoder will be one of a new start: a file that made one crash must not learn
  /// from it where things are in the memory of the next.
  void start_anew();

 private:
  absl::Status start();
  absl::StatusOr<Decoder> make();

  const DecoderProgram program_;
  const std::function<bool()> cancelled_;
  std::optional<Decoder> original_, ready_;
};

}  // namespace tet
