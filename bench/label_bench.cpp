// What meshes of labels cost: indicators, and tets from indicators that lie in memory.
//   label_bench [EDGE [LABELS]]      a segmentation of EDGE^3 voxels (64) with so many labels
//   (20)
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/labels/indicators.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/make/fill_mesh.h"

namespace tet {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Voronoi cells of random points, as voxels.
class Grains final : public LabelVoxels {
 public:
  Grains(std::int32_t edge, Label labels) : edge_(edge) {
    std::mt19937 random(1);
    std::vector<std::array<double, 3>> points(labels);
    for (auto& point : points) {
      for (double& v : point) v = edge * static_cast<double>(random()) / 4294967296.0;
    }
    const auto square = [](double v) { return v * v; };
    for (std::int32_t i = 0; i < edge * edge * edge; ++i) {
      const double x = i / edge / edge, y = i / edge % edge, z = i % edge;
      double least = 1e300;
      Label nearest = 0;
      for (Label l = 0; l < labels; ++l) {
        const double far =
            square(points[l][0] - x) + square(points[l][1] - y) + square(points[l][2] - z);
        if (far >= least) continue;
        least = far;
        nearest = l;
      }
      label_.push_back(nearest);
    }
  }

  std::optional<Label> one_label(const VoxelBox&) const override { return std::nullopt; }
  void copy(const VoxelBox& box, Label* out) const override {
    const auto within = [&](std::int32_t v) { return std::clamp(v, 0, edge_ - 1); };
    for (std::int32_t x = box.min.x; x <= box.max.x; ++x) {
      for (std::int32_t y = box.min.y; y <= box.max.y; ++y) {
        const std::int32_t row = (within(x) * edge_ + within(y)) * edge_;
        for (std::int32_t z = box.min.z; z <= box.max.z; ++z) {
          *out++ = label_[static_cast<std::size_t>(row + within(z))];
        }
      }
    }
  }

 private:
  std::int32_t edge_;
  std::vector<Label> label_;
};

/// What a source said of every brick, kept.
class KeptSamples final : public LabelSource {
 public:
  KeptSamples(const LabelSource& source, const BrickBox& box) {
    const auto sampler = source.sampler();
    EdgeSets changes;
    const double start = cpu_seconds();
    for_each_brick({box.min, {box.max.x + 1, box.max.y + 1, box.max.z + 1}}, [&](BrickCoord b) {
      Kept& kept = kept_[{b.x, b.y, b.z}];
      kept.one = sampler->one_label(b);
      if (kept.one) return;
      ++sampled_;
      kept.samples = std::make_unique<LabelSamples>();
      sampler->sample_labels(b, *kept.samples);
      find_label_changes(kept.samples->label, changes);
      sampler->sample_fractions(b, changes, *kept.samples);
    });
    seconds_ = cpu_seconds() - start;
  }

  std::size_t sampled() const { return sampled_; }
  std::size_t bricks() const { return kept_.size(); }
  double seconds() const { return seconds_; }

  std::unique_ptr<LabelSampler> sampler() const override {
    return std::make_unique<Sampler>(*this);
  }

 private:
  struct Kept {
    std::optional<Label> one;
    std::unique_ptr<LabelSamples> samples;
  };
  class Sampler final : public LabelSampler {
   public:
    explicit Sampler(const KeptSamples& of) : of_(of) {}
    std::optional<Label> one_label(BrickCoord b) override { return of_.at(b).one; }
    void sample_labels(BrickCoord b, LabelSamples& samples) override {
      samples.label = of_.at(b).samples->label;
    }
    void sample_fractions(BrickCoord b,
                          const EdgeSets& changes,
                          LabelSamples& samples) override {
      const LabelSamples& kept = *of_.at(b).samples;
      for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
        for_each_bit(changes[f], [&](int low) {
          samples.fraction[f][static_cast<std::size_t>(low)] =
              kept.fraction[f][static_cast<std::size_t>(low)];
        });
      }
    }

   private:
    const KeptSamples& of_;
  };

  const Kept& at(BrickCoord b) const { return kept_.at({b.x, b.y, b.z}); }

  std::map<std::tuple<int, int, int>, Kept> kept_;
  std::size_t sampled_ = 0;
  double seconds_ = 0;
};

void measure(std::int32_t edge, Label labels) {
  const auto voxels = std::make_shared<const Grains>(edge, labels);
  const BrickBox box{{0, 0, 0}, {edge / 8 - 1, edge / 8 - 1, edge / 8 - 1}};
  for (const auto& [name, kernel] : {std::pair("trilinear", LabelKernel::kTrilinear),
                                     {"quadratic", LabelKernel::kQuadratic},
                                     {"gauss 0.7", LabelKernel::kGauss}}) {
    const IndicatorLabels source(voxels, {.kernel = kernel});
    const auto kept = std::make_shared<const KeptSamples>(source, box);
    std::printf(
        "%-10s %zu of %zu bricks have several labels: %.3g of their nodes a CPU second\n", name,
        kept->sampled(), kept->bricks(),
        1024.0 * static_cast<double>(kept->sampled()) / kept->seconds());
    if (kernel != LabelKernel::kGauss) continue;
    for (const int levels : {0, kMaxLevels}) {
      LabelJob job;
      job.source = kept;
      job.domain = box;
      job.labels.resize(labels);
      job.request.levels = levels;
      const double start = cpu_seconds();
      const auto plan = plan_labels(job);
      if (!plan.ok()) return;
      const double planned = cpu_seconds();
      const auto mesh = fill_mesh(**plan, Cancellation(), nullptr);
      const double filled = cpu_seconds();
      const auto tets = static_cast<double>((*plan)->header().tet_count);
      std::printf(
          "%s: %.4g tets, %.2f .. %.2f degrees; plan %.3f s, fill %.3f s of CPU: %.3g tets "
          "a CPU second\n",
          levels == 0 ? "uniform" : "graded", tets, mesh->quality.min_dihedral_deg,
          mesh->quality.max_dihedral_deg, planned - start, filled - planned,
          tets / (filled - start));
    }
  }
}

}  // namespace
}  // namespace tet

int main(int argc, char** argv) {
  const int edge = argc > 1 ? std::stoi(argv[1]) : 64;
  const int labels = argc > 2 ? std::stoi(argv[2]) : 20;
  const tet::WorkerThreads threads;
  tet::TaskPool pool(1);
  pool.run([&] { tet::measure(edge / 8 * 8, static_cast<tet::Label>(labels)); });
  return 0;
}
