#include "core/labels/fill_labels.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "core/base/check.h"
#include "core/base/sse.h"
#include "core/stuffing/write_rows.h"

namespace tet {
namespace {

/// Bits of eight cells in a row where all of some nodes have a label.
class RowOfLabels {
 public:
  explicit RowOfLabels(const Label* first) noexcept
      : label_(load(first)), alike_(_mm_set1_epi16(-1)) {}

  void require(const Label* other) noexcept {
    alike_ = _mm_and_si128(alike_, _mm_cmpeq_epi16(label_, load(other)));
  }
  void require(Label label) noexcept {
    const __m128i all = _mm_set1_epi16(static_cast<short>(label));
    alike_ = _mm_and_si128(alike_, _mm_cmpeq_epi16(label_, all));
  }
  void exclude(Label label) noexcept {
    const __m128i all = _mm_set1_epi16(static_cast<short>(label));
    alike_ = _mm_andnot_si128(_mm_cmpeq_epi16(label_, all), alike_);
  }
  std::uint64_t bits() const noexcept {
    return static_cast<std::uint64_t>(_mm_movemask_epi8(_mm_packs_epi16(alike_, alike_)) &
                                      0xff);
  }

 private:
  static __m128i load(const Label* row) noexcept {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(row));
  }
  __m128i label_, alike_;
};

/// Asks `of_row(slot)` for the bits of each row of eight cells, whose first one's slot is
/// given.
template <class OfRow>
BrickMask mask_of_rows(const OfRow& of_row) noexcept {
  BrickMask mask;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      mask.slice[static_cast<std::size_t>(x)] |= of_row(node_slot(x, y, 0)) << (8 * y);
    }
  }
  return mask;
}

/// Those of some cells whose node at `first_node` has a label.
BrickMask cells_with_label(const Label* labels,
                           int first_node,
                           Label label,
                           const BrickMask& cells) noexcept {
  BrickMask found;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = cells.slice[x];
    for (int y = 0; y < 8; ++y) {
      if ((slice >> (8 * y) & 0xff) == 0) continue;
      RowOfLabels row(labels + first_node + node_slot(static_cast<int>(x), y, 0));
      row.require(label);
      found.slice[x] |= row.bits() << (8 * y);
    }
    found.slice[x] &= slice;
  }
  return found;
}

/// A cell of a mask that has any, as a slot.
int first_cell(const BrickMask& cells) noexcept {
  for (int x = 0; x < 8; ++x) {
    const std::uint64_t slice = cells.slice[static_cast<std::size_t>(x)];
    if (slice != 0) return cell_slot(x, std::countr_zero(slice));
  }
  return 0;
}

/// Labels of a brick and its surroundings by slot, for counting alone.
class LabelRows {
 public:
  explicit LabelRows(const LabelledParts& parts) noexcept {
    for (std::size_t o = 0; o < parts.size(); ++o) {
      for (const NodeKind kind : {kCorner, kCentre}) enter(parts[o], o, kind);
    }
  }
  const Label* data() const noexcept { return label_.data(); }

 private:
  void enter(const LabelledPart& part, std::size_t o, NodeKind kind) noexcept {
    const int bx = static_cast<int>(o >> 2), by = static_cast<int>(o >> 1 & 1),
              bz = static_cast<int>(o & 1);
    const std::size_t nodes = bz == 1 ? 1 : 8;
    for (int x = 0; x < (bx == 1 ? 1 : 8); ++x) {
      for (int y = 0; y < (by == 1 ? 1 : 8); ++y) {
        Label* const row =
            label_.data() + kind * kSlotsOfKind + node_slot(x + 8 * bx, y + 8 * by, 8 * bz);
        if (part.brick == nullptr) {
          std::fill_n(row, nodes, part.one);
        } else {
          std::copy_n(part.brick->label[kind].data() + (x * 8 + y) * 8, nodes, row);
        }
      }
    }
  }

  std::array<Label, kFirstCutSlot> label_{};
};

std::uint64_t count_kept(const Label* labels,
                         int first_node,
                         const BrickMask& cells,
                         const KeptLabels& kept) noexcept {
  const std::uint64_t all = cells.count();
  if (kept.all() || all == 0) return all;
  return all - cells_with_label(labels, first_node, kept.left_out, cells).count();
}

int centre_of_cell() noexcept { return kSlotsOfKind; }

}  // namespace

LeafFaces::LeafFaces(const LeavesAround& leaves) noexcept {
  for (std::size_t direction = 0; direction < kFaceDirections; ++direction) {
    const int axis = static_cast<int>(direction) % 3;
    const BrickMask& beyond = *leaves.beyond[direction];
    const BrickMask across = direction < 3 ? next_along(axis, *leaves.own, beyond)
                                           : previous_along(axis, *leaves.own, beyond);
    ends[direction] = *leaves.own & ~across;
    if (direction < 3) pairs[direction] = *leaves.own & across;
  }
}

BrickMask alike_tets(const Label* labels, std::size_t shape) noexcept {
  const auto& corner = kLabelShapeSlots[shape].corner;
  return mask_of_rows([&](int slot) {
    RowOfLabels row(labels + corner[0] + slot);
    for (std::size_t i = 1; i < 4; ++i) row.require(labels + corner[i] + slot);
    row.exclude(kJoker);
    return row.bits();
  });
}

BrickMask alike_pyramids(const Label* labels, int direction) noexcept {
  return mask_of_rows([&](int slot) {
    RowOfLabels row(labels + centre_of_cell() + slot);
    for (int turn = 0; turn < 4; ++turn) {
      const LatticeCoord at = face_turn(direction, turn);
      row.require(labels + slot + node_slot(at.x, at.y, at.z));
    }
    row.exclude(kJoker);
    return row.bits();
  });
}

std::uint64_t count_alike(const LabelledParts& parts,
                          const LeafFaces& faces,
                          const KeptLabels& kept) noexcept {
  std::uint64_t count = 0;
  if (parts[0].brick == nullptr) {
    if (!kept.holds(parts[0].one)) return 0;
    for (const BrickMask& pairs : faces.pairs) count += 4 * std::uint64_t{pairs.count()};
    for (const BrickMask& ends : faces.ends) count += 2 * std::uint64_t{ends.count()};
    return count;
  }
  const LabelRows rows(parts);
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    count += count_kept(rows.data(), kLabelShapeSlots[shape].corner[0],
                        alike_tets(rows.data(), shape) & faces.pairs[shape / 4], kept);
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const BrickMask& ends = faces.ends[static_cast<std::size_t>(direction)];
    if (!ends.any()) continue;
    count += 2 * count_kept(rows.data(), centre_of_cell(),
                            alike_pyramids(rows.data(), direction) & ends, kept);
  }
  return count;
}

LabelFillScratch::LabelFillScratch() : index_of_(std::size_t{1} << 16) {}

/// Parts cells whose tets are alike by label.
void LabelFiller::add_runs(const Label* labels,
                           int first_node,
                           std::uint8_t part,
                           BrickMask cells,
                           const KeptLabels& kept) {
  while (cells.any()) {
    const Label label = labels[first_node + first_cell(cells)];
    const BrickMask found = cells_with_label(labels, first_node, label, cells);
    cells &= ~found;
    if (kept.holds(label)) scratch_.runs_.push_back({label, part, found});
  }
}

void LabelFiller::divide_cells(const LabelledCells& cells,
                               std::size_t number,
                               const BrickMask& divided) {
  const auto& corner = kLabelShapeSlots[number].corner;
  const bool negative = kTetShape[number].negative;
  LabelDivision division;
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t bits = divided.slice[static_cast<std::size_t>(x)]; bits != 0;
         bits &= bits - 1) {
      const int bit = std::countr_zero(bits), cell = cell_slot(x, bit);
      LabelledTet tet = cells.vertices.tet(number, cell);
      tet.decided = cells.vertices.middle(number, x, bit);
      const bool all_moved =
          std::ranges::all_of(tet.label, [](Label l) { return l == kJoker; });
      divide(tet, all_moved ? cells.vertices.votes(number, cell) : JokerVotes{}, division);
      for (std::size_t i = 0; i < division.count; ++i) {
        if (!cells.kept.holds(division.label[i])) continue;
        LocalTet slots;
        for (std::size_t c = 0; c < 4; ++c) {
          const LabelCorner of = division.tet[i][c];
          slots[c] = static_cast<Slot>(of == kLabelMiddle ? label_middle_slot(number, x, bit)
                                                          : corner[of] + cell);
        }
        if (negative) std::swap(slots[2], slots[3]);
        scratch_.tets_.push_back(slots);
        scratch_.label_.push_back(division.label[i]);
      }
    }
  }
}

void LabelFiller::find_runs(const LabelledCells& cells) {
  scratch_.runs_.clear();
  scratch_.tets_.clear();
  scratch_.label_.clear();
  const LeafFaces& faces = cells.faces;
  if (cells.own.brick == nullptr) {
    if (!cells.kept.holds(cells.own.one)) return;
    for (std::uint8_t part = 0; part < kTetShapes + kFaceDirections; ++part) {
      const BrickMask& mask = part < kTetShapes ? faces.pairs[part / 4U]
                                                : faces.ends[part - std::size_t{kTetShapes}];
      if (mask.any()) scratch_.runs_.push_back({cells.own.one, part, mask});
    }
    return;
  }
  const Label* const labels = cells.vertices.labels();
  for (std::uint8_t shape = 0; shape < kTetShapes; ++shape) {
    const BrickMask& pairs = faces.pairs[shape / 4U];
    const BrickMask alike = alike_tets(labels, shape);
    add_runs(labels, kLabelShapeSlots[shape].corner[0], shape, alike & pairs, cells.kept);
    divide_cells(cells, shape, pairs & ~alike);
  }
  for (int direction = 0; direction < kFaceDirections; ++direction) {
    const BrickMask& ends = faces.ends[static_cast<std::size_t>(direction)];
    if (!ends.any()) continue;
    add_runs(labels, centre_of_cell(), static_cast<std::uint8_t>(kTetShapes + direction),
             alike_pyramids(labels, direction) & ends, cells.kept);
  }
}

void LabelFiller::sort_by_label() {
  LabelFillScratch& s = scratch_;
  s.labels_.clear();
  s.first_.clear();
  constexpr std::uint16_t kNew = 0;
  const auto note = [&](Label label) {
    if (s.index_of_[label] != kNew) return;
    s.index_of_[label] = 1;
    s.labels_.push_back(label);
  };
  for (const auto& run : s.runs_) note(run.label);
  for (const Label label : s.label_) note(label);
  std::ranges::sort(s.labels_);
  for (std::size_t i = 0; i < s.labels_.size(); ++i) {
    s.index_of_[s.labels_[i]] = static_cast<std::uint16_t>(i);
  }
  s.first_.assign(s.labels_.size() + 1, 0);
  for (const Label label : s.label_) ++s.first_[s.index_of_[label] + std::size_t{1}];
  for (std::size_t i = 0; i < s.labels_.size(); ++i) s.first_[i + 1] += s.first_[i];
  s.sorted_.resize(s.tets_.size());
  for (std::size_t i = 0; i < s.tets_.size(); ++i) {
    s.sorted_[s.first_[s.index_of_[s.label_[i]]]++] = s.tets_[i];
  }
  // Each beginning has become the end of its label.
  for (std::size_t i = s.labels_.size(); i > 0; --i) s.first_[i] = s.first_[i - 1];
  s.first_[0] = 0;
  for (const Label label : s.labels_) s.index_of_[label] = kNew;
  std::ranges::sort(s.runs_, {},
                    [](const auto& run) { return std::pair(run.label, run.part); });
}

template <class Index>
FilledLabels LabelFiller::fill(const LabelledCells& cells,
                               const LabelIds<Index>& ids,
                               std::span<Index> tets,
                               std::span<std::byte> labels) {
  find_runs(cells);
  sort_by_label();
  FilledLabels filled;
  Index* out = tets.data();
  const Index* const limit = tets.data() + tets.size();
  const auto corner_id = [&](int x, int y, int z) {
    return ids[static_cast<std::size_t>(node_slot(x, y, z))];
  };
  std::byte* label_out = labels.data();
  auto run = scratch_.runs_.begin();
  for (std::size_t l = 0; l < scratch_.labels_.size(); ++l) {
    const Label label = scratch_.labels_[l];
    Index* const begin = out;
    for (; run != scratch_.runs_.end() && run->label == label; ++run) {
      if (run->part < kTetShapes) {
        out = write_rows(run->cells, kLabelShapeSlots[run->part].whole, ids.data(), out, limit);
        filled.counts.bcc += run->cells.count();
        continue;
      }
      const int direction = run->part - kTetShapes;
      filled.counts.half_pyramid += 2 * std::uint64_t{run->cells.count()};
      for_each_bit(run->cells, [&](int x, int y, int z) {
        const Index centre = ids[static_cast<std::size_t>(kSlotsOfKind + node_slot(x, y, z))];
        out = write_half_pyramids(direction, Cell(x, y, z), centre, corner_id, out);
      });
    }
    for (std::uint32_t i = scratch_.first_[l]; i < scratch_.first_[l + 1]; ++i) {
      const auto& [a, b, c, d] = scratch_.sorted_[i];
      out = write_tet(out, ids[a], ids[b], ids[c], ids[d]);
    }
    if (labels.empty()) continue;
    for (const Index* tet = begin; tet != out; tet += 4, label_out += sizeof(label)) {
      std::memcpy(label_out, &label, sizeof(label));
    }
  }
  TET_CHECK(out == limit && label_out == labels.data() + labels.size());
  filled.divided = scratch_.sorted_;
  return filled;
}

template FilledLabels LabelFiller::fill(const LabelledCells&,
                                        const LabelIds<std::uint32_t>&,
                                        std::span<std::uint32_t>,
                                        std::span<std::byte>);
template FilledLabels LabelFiller::fill(const LabelledCells&,
                                        const LabelIds<std::uint64_t>&,
                                        std::span<std::uint64_t>,
                                        std::span<std::byte>);

}  // namespace tet
