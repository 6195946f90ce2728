// Solids as labels: level sets of one file, or the parts of a scene, that compete for each node
// of one lattice.
#pragma once

#include <memory>
#include <vector>

#include "core/base/scratch_pool.h"
#include "core/field/phi_field.h"
#include "core/labels/label.h"
#include "core/labels/label_samples.h"

namespace tet {

/// Whose label a node has that lies within several solids.
enum class Overlap : std::uint8_t {
  kDeepest,  ///< of the solid with the lowest phi: interfaces lie where two phi are equal
  kFirst,    ///< of the first of them: it is whole, and the others have what it leaves
};

/// A solid and the number of its label. Several may have one number.
struct LabelledField {
  PhiField field;  ///< of the common lattice
  Label label = 0;
};

/// Labels where phi is not above 0; everywhere else is `background`. An edge between two solids
/// is cut where their phi are equal, or of kFirst where that of the earlier one is zero; one to
/// the background where the solid's is zero: by secant steps on phi itself, and of kFirst
/// within kZeroTolerance.
///
/// With kFirst, phi within a millionth of a spacing is zero: solids that touch share their
/// nodes whatever rounding makes of them.
class FieldLabels final : public LabelSource {
 public:
  /// The fields' shapes outlive it. Of kDeepest the order of fields is of no account: of equal
  /// phi the lower label wins.
  FieldLabels(std::vector<LabelledField> fields, Label background, Overlap overlap);
  ~FieldLabels() override;

  std::unique_ptr<LabelSampler> sampler() const override;
  std::unique_ptr<InterfaceProbe> probe() const override;

  struct Scratch;

 private:
  const std::vector<LabelledField> fields_;
  const Label background_;
  const Overlap overlap_;
  const std::unique_ptr<ScratchPool<Scratch>> scratch_;
};

}  // namespace tet
