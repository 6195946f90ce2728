// Decoders for one file after another, without starting the program for each.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <absl/status/statusor.h>

#include "core/vdb/decoder/decoder.h"

namespace tet {

/// Starts the program once and copies it for each file; the original never sees one.
///
/// Starting it takes some 40 ms of the processor, nearly all to find OpenVDB's symbols, and
/// copying it one. Not thread-safe: decoders end with the thread that asked for them.
class DecoderSupply {
 public:
  /// Polled while a decoder starts.
  using Cancelled = std::function<bool()>;

  explicit DecoderSupply(DecoderProgram program) : program_(std::move(program)) {}

  /// Has a decoder stand ready, where that is possible.
  void prepare(const Cancelled& cancelled);

  /// The one that stands ready, or a new one. Errors: kUnavailable; kCancelled.
  absl::StatusOr<Decoder> take(const Cancelled& cancelled);

  /// The next decoder will be one of a new start: a file that made one crash must not learn
  /// from it where things are in the memory of the next.
  void start_anew();

 private:
  absl::Status start(const Cancelled& cancelled);
  absl::StatusOr<Decoder> make(const Cancelled& cancelled);

  const DecoderProgram program_;
  std::optional<Decoder> original_, ready_;
};

}  // namespace tet
