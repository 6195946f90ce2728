// One background tet that the surface cuts: which tets stand for its inside.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/types.h"
#include "core/stuffing/column_rule.h"
#include "core/stuffing/stencil.h"

namespace tet {

/// A tet of a background, of any shape, its nodes in ascending order.
struct SplitTet {
  std::array<NodeSign, 4> sign{};     ///< after the warp
  std::array<WorldPoint, 4> place{};  ///< before it
  EdgeFractions fraction{};

  bool is_cut(std::size_t a, std::size_t b) const noexcept {
    return sign[a] != NodeSign::kZero && sign[b] != NodeSign::kZero && sign[a] != sign[b];
  }

  /// The tets that stand for it, positive where it is.
  StencilTets tets() const noexcept;

 private:
  bool takes_second_diagonal(const ColumnRule& columns) const noexcept;
  WorldPoint cut(std::size_t a, std::size_t b) const noexcept;
};

}  // namespace tet
