// Counting and filling a finest brick of labels: the tets of its cells, label after label.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/local_point.h"
#include "core/labels/label.h"
#include "core/labels/label_vertices.h"
#include "core/lattice/background.h"
#include "core/stuffing/cell_nodes.h"

namespace tet {

/// The faces of a brick's leaves.
struct LeafFaces {
  std::array<BrickMask, 3> pairs;               ///< a leaf across the upper face, by axis
  std::array<BrickMask, kFaceDirections> ends;  ///< no leaf across the face
  explicit LeafFaces(const LeavesAround& leaves) noexcept;
};

/// Cells whose tet of a shape has nodes of one label, none of which moved: a BCC tet of that
/// label. `labels` are those of a brick by slot.
BrickMask alike_tets(const Label* labels, std::size_t shape) noexcept;
/// Cells whose half pyramids across `direction` have nodes of one label.
BrickMask alike_pyramids(const Label* labels, int direction) noexcept;

/// Tets of a brick whose nodes are alike, half pyramids included; those of labels that are
/// meshed.
std::uint64_t count_alike(const LabelledParts& parts,
                          const LeafFaces& faces,
                          const KeptLabels& kept) noexcept;

/// Scratch memory for filling.
class LabelFillScratch {
 public:
  LabelFillScratch();

 private:
  friend class LabelFiller;
  struct Run {
    Label label;
    std::uint8_t part;  ///< a shape, or kTetShapes and a direction
    BrickMask cells;
  };
  std::vector<Run> runs_;
  std::vector<LocalTet> tets_;           // divided ones, as they come
  std::vector<Label> label_;             // of each
  std::vector<LocalTet> sorted_;         // by label
  std::vector<Label> labels_;            // that there are, ascending
  std::vector<std::uint32_t> first_;     // of each label, in sorted_
  std::vector<std::uint16_t> index_of_;  // by label
};

/// What is filled.
struct LabelledCells {
  const LabelVertices& vertices;
  const LeafFaces& faces;
  const LabelledPart& own;
  KeptLabels kept;
};

/// What was filled, to be measured.
struct FilledLabels {
  std::span<const LocalTet> divided;  ///< tets that are no background tets
  BackgroundCounts counts;            ///< the others
};

/// Fills a brick's tets.
class LabelFiller {
 public:
  explicit LabelFiller(LabelFillScratch& scratch) noexcept : scratch_(scratch) {}

  /// Writes tets, four ids each, and a label for each; returns what they are. The spans have
  /// exactly the brick's size.
  template <class Index>
  FilledLabels fill(const LabelledCells& cells,
                    const LabelIds<Index>& ids,
                    std::span<Index> tets,
                    std::span<std::byte> labels);

 private:
  void find_runs(const LabelledCells& cells);
  void add_runs(const Label* labels,
                int first_node,
                std::uint8_t part,
                BrickMask cells,
                const KeptLabels& kept);
  void divide_cells(const LabelledCells& cells, std::size_t shape, const BrickMask& divided);
  void sort_by_label();

  LabelFillScratch& scratch_;
};

}  // namespace tet
