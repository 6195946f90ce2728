// The leaves of a session's frame, in however many messages they come.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "core/volume/replace_leaves.h"
#include "proto/wire/sha256.h"
#include "server/streams/call_charge.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Gathers a frame's leaves, message by message; how they were divided makes no difference to
/// what they are, nor to what the grid with them is called.
class FrameLeaves {
 public:
  /// `before` is the digest of the grid that they change. What they take is charged to
  /// `charge`.
  FrameLeaves(const std::string& before, std::shared_ptr<CallCharge> charge);

  /// Takes those of one message. Errors: kInvalidArgument (INVALID_FIELD: what is no leaf, by
  /// its number within the frame), those of CallCharge::add.
  absl::Status add(const v1::RemeshFrame& message);

  const std::vector<LeafValues>& leaves() const noexcept { return leaves_; }

  /// The digest of the grid that they make. To be asked once.
  std::string digest() noexcept { return digest_.finish_hex(); }

 private:
  absl::Status add_leaf(const v1::LeafUpdate& leaf, float*& to);

  const std::shared_ptr<CallCharge> charge_;
  std::vector<std::vector<float>> values_;  ///< of each message
  std::vector<LeafValues> leaves_;
  Sha256 digest_;
};

}  // namespace tet
