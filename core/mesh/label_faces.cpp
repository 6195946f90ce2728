#include "core/mesh/label_faces.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace tet {
namespace {

/// What lies on the two sides of a face, as one number: in front, and one more than that
/// behind, so that surfaces come before interfaces.
using LabelPair = std::uint32_t;

LabelPair pair_of(LabelNumber front, LabelNumber behind) noexcept {
  return (LabelPair{front} << 16) + ((behind + LabelPair{1}) & 0xffffU);
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
                                std::span<const LabelNumber> behind) {
  std::vector<LabelPair> of_face(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    of_face[i] = pair_of(mesh.label(faces[i].tet()), behind[i]);
  }
  std::vector<LabelPair> pairs = of_face;
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  if (pairs.size() > kMaxFaceLabels) {
    return {std::move(faces),
            {{.name = "surface", .kind = FaceKind::kSurface},
             {.name = "interface", .kind = FaceKind::kInterface}},
            [](const TetFace& face, const Triangle&) {
              return static_cast<std::uint16_t>(face.is_interface ? 1 : 0);
            }};
  }
  // Faces are in the order of their indices.
  std::vector<std::pair<std::uint64_t, std::uint16_t>> label_of_face;
  label_of_face.reserve(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto at = std::ranges::lower_bound(pairs, of_face[i]) - pairs.begin();
    label_of_face.emplace_back(faces[i].index, static_cast<std::uint16_t>(at));
  }
  return {std::move(faces), labels_of_pairs(pairs, mesh.header.labels),
          [all = std::move(label_of_face)](const TetFace& face, const Triangle&) {
            const auto at = std::ranges::lower_bound(
                all, face.index, {}, &std::pair<std::uint64_t, std::uint16_t>::first);
            return at->second;
          }};
}

}  // namespace tet
