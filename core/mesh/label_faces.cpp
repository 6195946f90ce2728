#include "core/mesh/label_faces.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "core/base/parallel.h"

namespace tet {
namespace {

/// What lies on the two sides of a face, as one number: in front, and one more than that
/// behind, so that surfaces come before interfaces.
using LabelPair = std::uint32_t;

LabelPair pair_of(const TetMesh& mesh, const TetFace& face) noexcept {
  const LabelNumber front = mesh.label(face.tet());
  return (LabelPair{front} << 16) + ((face.behind + LabelPair{1}) & 0xffffU);
}

void keep_distinct(std::vector<LabelPair>& pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

/// All that there are, ascending. Many faces have few of them.
std::vector<LabelPair> pairs_of(const TetMesh& mesh,
                                std::span<const TetFace> faces,
                                const Cancellation& cancellation) {
  constexpr std::size_t kFacesPerTask = 16384;
  std::vector<std::vector<LabelPair>> of_range((faces.size() + kFacesPerTask - 1) /
                                               kFacesPerTask);
  for_each_index(of_range.size(), [&](std::size_t range) {
    if (cancellation.requested()) return;
    const std::size_t begin = range * kFacesPerTask;
    std::vector<LabelPair> pairs;
    for (const TetFace& face :
         faces.subspan(begin, std::min(kFacesPerTask, faces.size() - begin))) {
      pairs.push_back(pair_of(mesh, face));
    }
    keep_distinct(pairs);
    of_range[range].assign(pairs.begin(), pairs.end());
  });
  std::vector<LabelPair> all;
  for (const std::vector<LabelPair>& pairs : of_range) {
    all.insert(all.end(), pairs.begin(), pairs.end());
  }
  keep_distinct(all);
  return all;
}

/// A name that nothing else has so far.
std::string free_name(const std::string& wanted, std::set<std::string>& taken) {
  std::string name = wanted;
  for (int number = 2; !taken.insert(name).second; ++number) {
    name = wanted + "_" + std::to_string(number);
  }
  return name;
}

std::vector<FaceLabel> labels_of_pairs(const std::vector<LabelPair>& pairs,
                                       std::span<const MeshLabel> labels) {
  const std::vector<std::string> names = distinct_names(labels);
  std::set<std::string> taken;
  std::vector<FaceLabel> all;
  for (const LabelPair pair : pairs) {
    const std::string& front = names[pair >> 16];
    const std::uint32_t behind = pair & 0xffffU;
    const bool outer = behind == 0;
    const std::string wanted = front + "_" + (outer ? "surface" : names[behind - 1]);
    all.push_back({.name = free_name(wanted, taken),
                   .kind = outer ? FaceKind::kSurface : FaceKind::kInterface});
  }
  return all;
}

}  // namespace

std::vector<std::string> distinct_names(std::span<const MeshLabel> labels) {
  std::map<std::string, int> uses;
  for (const MeshLabel& label : labels) ++uses[label.name];
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const MeshLabel& label : labels) {
    const std::string value = std::to_string(label.value);
    const std::string wanted = label.name.empty()     ? "label_" + value
                               : uses[label.name] > 1 ? label.name + "_" + value
                                                      : label.name;
    names.push_back(free_name(wanted, taken));
  }
  return names;
}

FoundFaces faces_between_labels(const TetMesh& mesh,
                                std::vector<TetFace> faces,
                                const Cancellation& cancellation) {
  std::vector<LabelPair> pairs = pairs_of(mesh, faces, cancellation);
  if (pairs.size() > kMaxFaceLabels) {
    return {std::move(faces),
            {{.name = "surface", .kind = FaceKind::kSurface},
             {.name = "interface", .kind = FaceKind::kInterface}},
            [](const TetFace& face, const Triangle&) {
              return static_cast<std::uint16_t>(face.is_interface ? 1 : 0);
            }};
  }
  std::vector<FaceLabel> labels = labels_of_pairs(pairs, mesh.header.labels);
  return {std::move(faces), std::move(labels),
          [&mesh, pairs = std::move(pairs)](const TetFace& face, const Triangle&) {
            const auto at = std::ranges::lower_bound(pairs, pair_of(mesh, face));
            return static_cast<std::uint16_t>(at - pairs.begin());
          }};
}

}  // namespace tet
