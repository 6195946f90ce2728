// A chunk's columns in a fifth of the bytes, whatever mesh they are of: what lies beside each
// other is alike. docs/wire_format.md has it byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <absl/status/status.h>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Packs chunks, one after another in the same memory. Not thread-safe.
class ChunkPacker {
 public:
  /// A chunk's columns as the bytes that carry them, the same for the same columns; they last
  /// until the next are packed. None where the tets have more than 65,536 vertices.
  std::span<const std::byte> pack(const MeshHeader& header,
                                  const ChunkExtent& extent,
                                  const ChunkColumns& columns);

 private:
  template <class Id>
  bool number_corners(const ChunkExtent& extent, std::span<const std::byte> tets);
  template <class Word>
  void pack_positions(std::span<const std::byte> positions);
  void pack_tets();

  struct RecentVertex {
    std::uint64_t id = ~std::uint64_t{0};
    std::uint64_t number = 0;
  };
  static constexpr std::size_t kRecentVertices = 8192;

  RecentVertex& recent(std::uint64_t id) noexcept { return recent_[id % kRecentVertices]; }
  template <class Id>
  void find_others(std::span<const std::byte> tets);

  std::vector<std::uint16_t> corners_;    ///< of tets, by the chunk's own numbers
  std::vector<std::uint32_t> elsewhere_;  ///< which of those are vertices of other chunks
  std::vector<std::uint64_t> others_;     ///< ids of those, sorted
  std::vector<RecentVertex> recent_;      ///< some of them by their last bits: no search
  std::vector<std::uint16_t> steps_;      ///< from corner to corner
  std::vector<std::uint16_t> patterns_;   ///< of vertices or tets
  std::vector<std::byte> bytes_;          ///< what came of it
};

/// Unpacks chunks, one after another in the same memory. Not thread-safe.
class ChunkUnpacker {
 public:
  /// Writes a chunk's columns, which have exactly its ChunkSizes; all ids are vertices of the
  /// mesh. Errors: kDataLoss (bytes that no packer writes), with columns half written.
  absl::Status unpack(std::span<const std::byte> bytes,
                      const MeshHeader& header,
                      const ChunkExtent& extent,
                      const ChunkColumns& columns);

 private:
  std::vector<std::uint32_t> ids_;       ///< by the chunk's own numbers
  std::vector<std::uint64_t> wide_ids_;  ///< the same, of a mesh with more vertices
  std::vector<std::byte> rows_;          ///< positions, and four before the first
};

}  // namespace tet
