// What excludes what in a request for a mesh, and why: the one table that the mesher, the
// server, the command line, the tests and docs/requests.md read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/status.h>

#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"

namespace tet {

/// What a request may ask for, and how the mesh may be asked for.
enum class Feature : std::uint8_t {
  // What is meshed.
  kStoredGrid,
  kGridName,
  kSeveralGrids,
  kScene,
  kIso,
  kInside,
  kLabels,
  // How it is meshed.
  kBothSides,
  kCut,
  kManifold,
  kSizing,
  kSizingGrid,
  kGradedSurface,
  kImprove,
  kFields,
  kFaces,
  kFaceRegions,
  kFidelity,
  kFloat64,
  kSkipStatistics,
  // How the mesh is asked for, and how it comes.
  kChunkRange,
  kPacked,
  kCompact,
  kEarlierMesh,
  kSession,
  kJob,
  kPoints,  ///< the request says what points are looked up in
};

inline constexpr std::size_t kFeatureCount = static_cast<std::size_t>(Feature::kPoints) + 1;

/// In the order of the enumeration.
constexpr std::array<Feature, kFeatureCount> all_features() {
  std::array<Feature, kFeatureCount> all{};
  for (std::size_t i = 0; i < kFeatureCount; ++i) all[i] = static_cast<Feature>(i);
  return all;
}

/// The features that one request has.
class Features {
 public:
  constexpr Features() = default;
  constexpr Features(std::initializer_list<Feature> features) {
    for (const Feature feature : features) add(feature);
  }

  constexpr Features& add(Feature feature, bool is_asked_for = true) {
    if (is_asked_for) bits_ |= bit(feature);
    return *this;
  }
  constexpr bool has(Feature feature) const { return (bits_ & bit(feature)) != 0; }
  friend constexpr Features operator|(Features a, Features b) {
    a.bits_ |= b.bits_;
    return a;
  }
  friend constexpr bool operator==(Features, Features) = default;

 private:
  static constexpr std::uint32_t bit(Feature feature) {
    return std::uint32_t{1} << static_cast<std::uint32_t>(feature);
  }
  std::uint32_t bits_ = 0;
};
static_assert(kFeatureCount <= 32);

/// What becomes of a request that has both features of a rule.
enum class Outcome : std::uint8_t {
  kRefused,    ///< INVALID_ARGUMENT, with the rule's message
  kSentWhole,  ///< nothing is kept of the earlier mesh: all of the mesh is sent
  kIgnored,    ///< the first feature changes nothing
};

/// One pair of features that do not go together.
struct RequestRule {
  Feature feature;  ///< whose field a refusal names
  Feature beside;
  Outcome outcome;
  /// `$0` and `$1` are what the caller calls the two features, `$2` what it calls packed
  /// chunks. Only for what is refused.
  std::string_view refusal;
  std::string_view instead;  ///< what to do about it, as part of the message
  std::string_view why;      ///< a sentence for docs/requests.md
};

/// Each pair at most once.
std::span<const RequestRule> request_rules();

/// Null where the two go together, or where nobody can ask for both.
const RequestRule* find_rule(Feature a, Feature b);

/// Whether one request can have both features. A call has one encoding; a session, a job and
/// points take a mesh's request alone; and with both sides or labels a box is not a cut, but
/// where they end.
bool can_be_asked_together(Feature a, Feature b);

/// What a caller calls each feature.
class FeatureNames {
 public:
  explicit FeatureNames(const std::array<std::string_view, kFeatureCount>& names) {
    for (std::size_t i = 0; i < kFeatureCount; ++i) names_[i] = names[i];
  }
  const std::string& of(Feature feature) const {
    return names_[static_cast<std::size_t>(feature)];
  }
  /// Shows the value that was given, too: `iso 0.5`.
  FeatureNames& set(Feature feature, std::string name) {
    names_[static_cast<std::size_t>(feature)] = std::move(name);
    return *this;
  }

 private:
  std::array<std::string, kFeatureCount> names_;
};

/// As the service calls them: each begins with the field's name.
FeatureNames field_names();
/// Each with the value that the request has, where a refusal should show it.
FeatureNames field_names(const MeshRequest& request);

Features features_of(const MeshRequest& request);
Features features_of(const Shape& shape);

/// What a rule says to a caller who refers to the features by these names.
std::string message_of(const RequestRule& rule, const FeatureNames& names);

/// OK, or kInvalidArgument with the message of the first rule that the features break.
absl::Status check_features(Features features, const FeatureNames& names);

/// Whether parts of an earlier mesh can be kept at all, as far as the request tells.
bool may_keep_parts(Features features);

}  // namespace tet
