// Where solids that are labels meet, at any point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/field/world_phi.h"
#include "core/labels/field_labels.h"
#include "core/labels/interface_probe.h"

namespace tet {

/// The functions of kDeepest are differences of phi, from that of the first label that was
/// chosen; those of kFirst the phi of all solids that meet but the last. Nobody's is 0, and
/// comes last. Of several solids with one label, one is looked at: whose label it is at the
/// point.
class FieldProbe final : public InterfaceProbe {
 public:
  /// The fields outlive it.
  FieldProbe(std::span<const LabelledField> fields, Label background, Overlap overlap);

  bool choose(std::span<const Label> labels, const WorldPoint& near) override;
  void at(const WorldPoint& p, std::span<ValueSlope> out) override;

 private:
  static constexpr std::size_t kNobody = ~std::size_t{0};

  WorldPhi& phi(std::size_t solid);
  double depth_of(std::size_t solid, const WorldPoint& world);
  std::size_t solid_of(Label label, const WorldPoint& world);
  ValueSlope slope_of(std::size_t solid, const WorldPoint& world);

  const std::span<const LabelledField> fields_;
  const Label background_;
  const Overlap overlap_;
  VoxelTransform lattice_;
  std::vector<std::unique_ptr<WorldPhi>> phi_;  // by the numbers of fields; null: not met yet

  // These belong to what was chosen.
  std::size_t chosen_ = 0;
  std::array<std::size_t, kMostMeeting> solid_{};
};

}  // namespace tet
