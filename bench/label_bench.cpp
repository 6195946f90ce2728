// What meshes of labels cost: indicators, and tets from indicators that lie in memory.
//   label_bench [EDGE [LABELS [indicators]]]
//   a segmentation of EDGE^3 voxels (64) with so many labels (20); its indicators alone
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/labels/indicators.h"
#include "core/labels/lattice_faces.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/labelled/volume_labels.h"
#include "core/plan/mesh_workspace.h"
#include "core/volume/label_volume.h"

namespace tet {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Voronoi cells of random points, as a segmentation.
std::shared_ptr<const LabelVolume> grains(std::int32_t edge, Label labels) {
  std::mt19937 random(1);
  std::vector<std::array<double, 3>> points(labels);
  for (auto& point : points) {
    for (double& v : point) v = edge * static_cast<double>(random()) / 4294967296.0;
  }
  const auto square = [](double v) { return v * v; };
  const VoxelTransform at_origin;
  LabelVolumeBuilder builder("grains", at_origin, {{0, 0, 0}, {edge - 1, edge - 1, edge - 1}});
  std::array<std::int64_t, kBrickCells> values;
  for_each_brick({{0, 0, 0}, {edge / 8 - 1, edge / 8 - 1, edge / 8 - 1}}, [&](BrickCoord b) {
    for (std::size_t i = 0; i < kBrickCells; ++i) {
      const std::size_t slice = i / 64;
      const double x = static_cast<double>(8 * b.x) + static_cast<double>(slice),
                   y = static_cast<double>(8 * b.y) + static_cast<double>(i / 8 % 8),
                   z = static_cast<double>(8 * b.z) + static_cast<double>(i % 8);
      double least = std::numeric_limits<double>::infinity();
      for (Label l = 0; l < labels; ++l) {
        const double far =
            square(points[l][0] - x) + square(points[l][1] - y) + square(points[l][2] - z);
        if (far >= least) continue;
        least = far;
        values[i] = l;
      }
    }
    if (!builder.add_brick(b, values).ok()) std::abort();
  });
  return std::make_shared<const LabelVolume>(std::move(builder).build());
}

/// The voxels of a segmentation, which has each label's number as its value.
std::shared_ptr<const LabelVoxels> voxels_of(std::shared_ptr<const LabelVolume> volume) {
  std::vector<Label> label_of(volume->labels.begin(), volume->labels.end());
  return std::make_shared<const VolumeLabels>(std::move(volume), std::move(label_of), 0);
}

/// What a sampler takes for all bricks of a box, of which nothing is kept.
struct SamplerCost {
  std::size_t bricks = 0, sampled = 0;
  double one_seconds = 0, sampled_seconds = 0;  ///< of CPU

  SamplerCost(const LabelSource& source, const BrickBox& box) {
    const auto sampler = source.sampler();
    LabelSamples samples;
    EdgeSets changes;
    std::vector<BrickCoord> several;
    double start = cpu_seconds();
    for_each_brick(box, [&](BrickCoord b) {
      ++bricks;
      if (!sampler->one_label(b)) several.push_back(b);
    });
    one_seconds = cpu_seconds() - start;
    sampled = several.size();
    start = cpu_seconds();
    for (const BrickCoord b : several) {
      if (sampler->one_label(b)) continue;
      sampler->sample_labels(b, samples);
      find_label_changes(samples.label, changes);
      sampler->sample_fractions(b, changes, samples);
    }
    sampled_seconds = cpu_seconds() - start;
  }
};

/// What a source said of every brick, kept.
class KeptSamples final : public LabelSource {
 public:
  KeptSamples(const LabelSource& source, const BrickBox& box) {
    const auto sampler = source.sampler();
    EdgeSets changes;
    for_each_brick({box.min, {box.max.x + 1, box.max.y + 1, box.max.z + 1}}, [&](BrickCoord b) {
      Kept& kept = kept_[{b.x, b.y, b.z}];
      kept.one = sampler->one_label(b);
      if (kept.one) return;
      kept.samples = std::make_unique<LabelSamples>();
      sampler->sample_labels(b, *kept.samples);
      find_label_changes(kept.samples->label, changes);
      sampler->sample_fractions(b, changes, *kept.samples);
      keep_faces(*sampler, b, changes, kept);
    });
  }

  std::unique_ptr<LabelSampler> sampler() const override {
    return std::make_unique<Sampler>(*this);
  }

 private:
  struct Kept {
    std::optional<Label> one;
    std::unique_ptr<LabelSamples> samples;
    std::vector<TripleFace> faces;  ///< of three labels, ascending
    std::vector<FacePoint> points;
  };

  /// All faces that may be asked for: those whose nodes have three labels.
  static void keep_faces(LabelSampler& sampler,
                         BrickCoord brick,
                         const EdgeSets& changes,
                         Kept& kept) {
    for (std::uint8_t f = 0; f < kFaceFamilies; ++f) {
      const FaceFamily& family = kFaceFamily[f];
      HaloSet found = halo_cube(0, 8);
      for (std::size_t e = 0; e < 3; ++e) {
        found &= seen_from(changes[family.edge_family[e]], family.to_node[kFaceEdge[e][0]]);
      }
      for (std::size_t n = 0; n < 3; ++n) {
        found &= seen_from(kKnownNodes, family.to_node[n]);
      }
      for_each_bit(found, [&](int low) {
        kept.faces.push_back({f, static_cast<std::uint16_t>(low)});
      });
    }
    kept.points.resize(kept.faces.size());
    sampler.sample_triples(brick, kept.faces, *kept.samples, kept.points);
  }
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

    void sample_triples(BrickCoord b,
                        std::span<const TripleFace> faces,
                        const LabelSamples&,
                        std::span<FacePoint> points) override {
      const Kept& kept = of_.at(b);
      for (std::size_t i = 0; i < faces.size(); ++i) {
        const auto found = std::ranges::lower_bound(kept.faces, faces[i]) - kept.faces.begin();
        points[i] = kept.points[static_cast<std::size_t>(found)];
      }
    }

   private:
    const KeptSamples& of_;
  };

  const Kept& at(BrickCoord b) const { return kept_.at({b.x, b.y, b.z}); }

  std::map<std::tuple<int, int, int>, Kept> kept_;
};

/// Tells meshes apart: FNV-1a of eight bytes at a time.
std::uint64_t digest_of(std::uint64_t digest, std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i + sizeof(digest) <= bytes.size(); i += sizeof(digest)) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data() + i, sizeof(word));
    digest = (digest ^ word) * 0x100000001b3;
  }
  return digest;
}

void measure_sampler(const char* name, const LabelSource& source, const BrickBox& box) {
  const SamplerCost cost(source, box);
  std::printf(
      "%-10s %zu of %zu bricks have several labels: %.3g of their nodes a CPU second; to "
      "find them: %.3g s\n",
      name, cost.sampled, cost.bricks,
      1024.0 * static_cast<double>(cost.sampled) / cost.sampled_seconds, cost.one_seconds);
}

/// Chunk after chunk into the same memory, as a server makes them.
void measure_mesh(const char* name, const LabelJob& job) {
  const double start = cpu_seconds();
  const auto plan = plan_labels(job);
  if (!plan.ok()) return;
  const double planned = cpu_seconds();
  const MeshHeader& header = (*plan)->header();
  std::vector<std::byte> bytes;
  MeshWorkspace workspace;
  QualityStats quality;
  std::uint64_t digest = 0xcbf29ce484222325;
  double filling = 0;
  for (std::uint64_t i = 0; i < header.chunk_count; ++i) {
    const double before = cpu_seconds();
    const ChunkExtent extent = (*plan)->chunk(i);
    const ChunkSizes size(header, extent.vertex_count, extent.tet_count);
    bytes.resize(std::max(bytes.size(), static_cast<std::size_t>(size.total())));
    const std::span all(bytes);
    const ChunkColumns columns{
        .positions = all.first(size.positions),
        .tets = all.subspan(size.positions, size.tets),
        .regions = all.subspan(size.positions + size.tets, size.regions)};
    quality.add((*plan)->fill_chunk(i, workspace, columns));
    filling += cpu_seconds() - before;
    digest = digest_of(digest, all.first(size.total()));
  }
  const auto tets = static_cast<double>(header.tet_count);
  std::printf(
      "%s: %.4g tets, %.2f .. %.2f degrees; plan %.3f s, fill %.3f s of CPU: %.3g tets a CPU "
      "second; %016llx\n",
      name, tets, quality.min_dihedral_deg, quality.max_dihedral_deg, planned - start, filling,
      tets / (planned - start + filling), static_cast<unsigned long long>(digest));
}

void measure(std::int32_t edge, Label labels, bool mesh) {
  const auto voxels = voxels_of(grains(edge, labels));
  const BrickBox box{{0, 0, 0}, {edge / 8 - 1, edge / 8 - 1, edge / 8 - 1}};
  for (const auto& [name, kernel] : {std::pair("trilinear", LabelKernel::kTrilinear),
                                     {"quadratic", LabelKernel::kQuadratic},
                                     {"gauss 0.7", LabelKernel::kGauss}}) {
    measure_sampler(name, IndicatorLabels(voxels, {.kernel = kernel}), box);
  }
  if (!mesh) return;
  const IndicatorLabels source(voxels, {});
  LabelJob job;
  job.source = std::make_shared<const KeptSamples>(source, box);
  job.domain = box;
  job.labels.resize(labels);
  for (const int levels : {0, kMaxLevels}) {
    job.request.levels = levels;
    measure_mesh(levels == 0 ? "uniform" : "graded", job);
  }
}

}  // namespace
}  // namespace tet

int main(int argc, char** argv) {
  const int edge = argc > 1 ? std::stoi(argv[1]) : 64;
  const int labels = argc > 2 ? std::stoi(argv[2]) : 20;
  const tet::WorkerThreads threads;
  tet::TaskPool pool(1);
  pool.run([&] { tet::measure(edge / 8 * 8, static_cast<tet::Label>(labels), argc <= 3); });
  return 0;
}
