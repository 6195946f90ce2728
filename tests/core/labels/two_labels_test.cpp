// Where two labels meet a mesh of labels is a mesh of both sides: the same vertices and tets.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/field/domain.h"
#include "core/field/phi_field.h"
#include "core/plan/make/mesher.h"
#include "core/stuffing/cut_points.h"
#include "tests/core/labels/label_meshing.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

/// The inside of a volume as label 0, its outside as label 1, cut where both sides are.
class SidesOfVolume final : public LabelSource {
 public:
  explicit SidesOfVolume(const Volume& volume) : field_{.volume = &volume, .scene = nullptr} {}

  std::unique_ptr<LabelSampler> sampler() const override {
    return std::make_unique<Sampler>(field_);
  }

 private:
  class Sampler final : public LabelSampler {
   public:
    explicit Sampler(const PhiField& field) : sampler_(field) {}

    std::optional<Label> one_label(BrickCoord) override { return std::nullopt; }
    void sample_labels(BrickCoord brick, LabelSamples& samples) override {
      sampler_.sample(brick, *phi_);
      for (std::size_t i = 0; i < kHaloNodes; ++i) {
        samples.label[kCorner][i] = phi_->corner[i] < 0 ? 0 : 1;
        samples.label[kCentre][i] = phi_->centre[i] < 0 ? 0 : 1;
      }
    }
    void sample_fractions(BrickCoord brick,
                          const EdgeSets& changes,
                          LabelSamples& samples) override {
      find_signs(*phi_, cuts_->signs);
      find_cut_points(*phi_, sampler_, brick, *cuts_);
      for (int f = 0; f < static_cast<int>(kEdgeFamilies); ++f) {
        const NodeKind kind = family_kind(f), end = end_kind(kind, family_direction(f));
        const int to_end = end_offset(kind, family_direction(f));
        for_each_bit(changes[static_cast<std::size_t>(f)], [&](int low) {
          // A node that lies on the surface is its own cut point.
          const float cut = phi_of(kind, low) == 0           ? 0
                            : phi_of(end, low + to_end) == 0 ? 1
                                                             : fraction_of(f, low);
          samples.fraction[static_cast<std::size_t>(f)][static_cast<std::size_t>(low)] = cut;
        });
      }
    }
    /// No face has three labels.
    void sample_triples(BrickCoord,
                        std::span<const TripleFace> faces,
                        const LabelSamples&,
                        std::span<FacePoint>) override {
      EXPECT_TRUE(faces.empty());
    }

   private:
    float phi_of(NodeKind kind, int node) const {
      const auto i = static_cast<std::size_t>(node);
      return kind == kCorner ? phi_->corner[i] : phi_->centre[i];
    }
    float fraction_of(int family, int low) const {
      return cuts_->fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(low)];
    }

    PhiSampler sampler_;
    std::unique_ptr<BrickSamples> phi_ = std::make_unique<BrickSamples>();
    std::unique_ptr<CutPoints> cuts_ = std::make_unique<CutPoints>();
  };

  PhiField field_;
};

using LabelledIds = std::array<std::uint64_t, 5>;

/// Tets with their label, wherever they are in the mesh and whichever corner comes first.
template <class LabelOf>
std::vector<LabelledIds> sorted_tets(const TetMesh& mesh, const LabelOf& label_of) {
  std::vector<LabelledIds> tets;
  for (std::uint64_t t = 0; t < mesh.header.tet_count; ++t) {
    auto ids = mesh.tet(t);
    std::ranges::sort(ids);
    tets.push_back({ids[0], ids[1], ids[2], ids[3], static_cast<std::uint64_t>(label_of(t))});
  }
  std::ranges::sort(tets);
  return tets;
}

TEST(TwoLabels, HaveTheMeshOfBothSides) {
  std::vector<std::pair<std::string, Volume>> fields;
  fields.emplace_back("ball", test::ball(11));
  fields.emplace_back("gyroid", test::gyroid_ball(24));
  fields.emplace_back("random signs", test::random_signs(14, 1));
  for (const auto& [name, volume] : fields) {
    for (const int levels : test::few_of(std::vector{0, 1, kMaxLevels}, 2)) {
      SCOPED_TRACE(name + ", levels " + std::to_string(levels));
      MeshRequest request;
      request.preset = Preset::kBothSides;
      request.levels = levels;
      const TetMesh both = test::mesh(volume, request).mesh;
      // The box that was meshed, from its origin, which lies in the middle.
      const auto domain = mesh_domain({.volume = &volume}, std::nullopt);
      ASSERT_TRUE(domain.ok());
      test::LabelMeshing how{.domain = *domain, .levels = levels};
      how.coordinates = CoordinateType::kFloat32;
      how.labels = 2;
      const TetMesh labels =
          test::mesh_of(std::make_shared<const SidesOfVolume>(volume), how).mesh;
      EXPECT_TRUE(std::ranges::equal(labels.positions.bytes(), both.positions.bytes()));
      const auto of_labels =
          sorted_tets(labels, [&](std::uint64_t t) { return labels.label(t); });
      const auto of_sides = sorted_tets(
          both, [&](std::uint64_t t) { return both.region(t) == MeshRegion::kInside ? 0 : 1; });
      EXPECT_TRUE(of_labels == of_sides);
    }
  }
}

}  // namespace
}  // namespace tet
