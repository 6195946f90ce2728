#include "client/command/arguments/face_options.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>
#include <absl/strings/string_view.h>

#include "client/command/process/interruption.h"
#include "client/library/text_file.h"
#include "core/plan/check_face_regions.h"
#include "proto/convert/face_regions.h"

namespace tet {
namespace {

using Numbers = std::vector<double>;

WorldPoint point_at(const Numbers& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

/// A kind of place that is written as numbers.
struct PlaceKind {
  absl::string_view name;
  std::size_t numbers;  ///< that it takes; 0: three a point, any number of points
  absl::string_view form;
  void (*set)(const Numbers& numbers, FaceRegion& region);
  bool (*is_set)(const FaceRegion& region);
};

constexpr std::array<PlaceKind, 7> kPlaceKinds{{
    {"box", 6, "X0,Y0,Z0,X1,Y1,Z1",
     [](const Numbers& n, FaceRegion& region) {
       region.box = {point_at(n, 0), point_at(n, 3)};
     },
     [](const FaceRegion& region) { return region.box.has_value(); }},
    {"ball", 4, "X,Y,Z,RADIUS",
     [](const Numbers& n, FaceRegion& region) {
       region.ball = {point_at(n, 0), n[3]};
     },
     [](const FaceRegion& region) { return region.ball.has_value(); }},
    {"cylinder", 7, "X0,Y0,Z0,X1,Y1,Z1,RADIUS",
     [](const Numbers& n, FaceRegion& region) {
       region.cylinder = {point_at(n, 0), point_at(n, 3), n[6]};
     },
     [](const FaceRegion& region) { return region.cylinder.has_value(); }},
    {"halfspace", 4, "NX,NY,NZ,OFFSET",
     [](const Numbers& n, FaceRegion& region) {
       region.half_space = {point_at(n, 0), n[3]};
     },
     [](const FaceRegion& region) { return region.half_space.has_value(); }},
    {"nearest", 0, "X,Y,Z,... (three a point)",
     [](const Numbers& n, FaceRegion& region) {
       for (std::size_t i = 0; i < n.size(); i += 3) region.nearest.push_back(point_at(n, i));
     },
     [](const FaceRegion& region) { return !region.nearest.empty(); }},
    {"facing", 4, "X,Y,Z,DEGREES",
     [](const Numbers& n, FaceRegion& region) {
       region.facing = {point_at(n, 0), n[3]};
     },
     [](const FaceRegion& region) { return region.facing.has_value(); }},
    {"creases", 1, "DEGREES",
     [](const Numbers& n, FaceRegion& region) { region.creases = {n[0]}; },
     [](const FaceRegion& region) { return region.creases.has_value(); }},
}};

absl::Status wrong(const std::string& option, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("--face ", option, ": ", what));
}

absl::Status set_once(const std::string& option, absl::string_view kind) {
  return wrong(option, absl::StrCat("it has two places of the kind ", kind,
                                    "; faces in either are in two --face of one name"));
}

absl::StatusOr<Numbers> parse_numbers(const std::string& option, absl::string_view text) {
  Numbers numbers;
  for (const absl::string_view part : absl::StrSplit(text, ',')) {
    double number = 0;
    if (!absl::SimpleAtod(part, &number)) {
      return wrong(option, absl::StrCat("\"", part, "\" is no number"));
    }
    numbers.push_back(number);
  }
  return numbers;
}

absl::Status add_numbers(const std::string& option,
                         const PlaceKind& kind,
                         absl::string_view text,
                         FaceRegion& region) {
  if (kind.is_set(region)) return set_once(option, kind.name);
  const absl::StatusOr<Numbers> numbers = parse_numbers(option, text);
  if (!numbers.ok()) return numbers.status();
  const bool fits =
      kind.numbers == 0 ? numbers->size() % 3 == 0 : numbers->size() == kind.numbers;
  if (!fits) {
    return wrong(option, absl::StrCat(kind.name, " takes ", kind.form, ", and here are ",
                                      numbers->size(), " numbers"));
  }
  kind.set(*numbers, region);
  return absl::OkStatus();
}

/// Adds one place, `KIND:...`, to the conditions of a region.
absl::Status add_place(const std::string& option, absl::string_view place, FaceRegion& region) {
  const std::size_t colon = place.find(':');
  const absl::string_view kind = place.substr(0, colon);
  const absl::string_view rest =
      colon == absl::string_view::npos ? absl::string_view() : place.substr(colon + 1);
  if (kind == "node") {
    if (!region.node.empty()) return set_once(option, kind);
    region.node = std::string(rest);
    return rest.empty() ? wrong(option, "node takes the name of a node of the scene")
                        : absl::OkStatus();
  }
  const auto* const known = std::ranges::find(kPlaceKinds, kind, &PlaceKind::name);
  if (known != kPlaceKinds.end()) return add_numbers(option, *known, rest, region);
  return wrong(option, absl::StrCat("\"", kind,
                                    "\" is no place: it is one of box, ball, cylinder, "
                                    "halfspace, nearest, facing, creases and node"));
}

absl::StatusOr<FaceRegion> parse_face(const std::string& option) {
  const std::size_t equals = option.find('=');
  if (equals == std::string::npos) {
    return wrong(option,
                 "it takes a name, =, and a place, as bore=cylinder:0,0,0,0,0,1,0.5; "
                 "or a .json file");
  }
  FaceRegion region{option.substr(0, equals)};
  for (const absl::string_view place :
       absl::StrSplit(absl::string_view(option).substr(equals + 1), '/')) {
    if (auto status = add_place(option, place, region); !status.ok()) return status;
  }
  return region;
}

absl::StatusOr<std::vector<FaceRegion>> read_regions(const std::string& option) {
  const bool is_text = absl::StartsWith(option, "{");
  const auto json = is_text ? absl::StatusOr<std::string>(option)
                            : read_text_file(option, user_interruption());
  if (!json.ok()) return json.status();
  auto regions = face_regions_from_json(*json);
  if (!regions.ok()) return about(is_text ? "--face" : option, regions.status());
  return regions;
}

}  // namespace

bool is_file_of_faces(const std::string& option) {
  return !absl::StartsWith(option, "{") && absl::EndsWith(option, ".json");
}

absl::StatusOr<std::vector<FaceRegion>> understand_faces(
    const std::vector<std::string>& options) {
  std::vector<FaceRegion> regions;
  for (const std::string& option : options) {
    if (absl::StartsWith(option, "{") || is_file_of_faces(option)) {
      auto read = read_regions(option);
      if (!read.ok()) return read.status();
      std::ranges::move(*read, std::back_inserter(regions));
      continue;
    }
    absl::StatusOr<FaceRegion> region = parse_face(option);
    if (!region.ok()) return region.status();
    regions.push_back(*std::move(region));
  }
  if (absl::Status status = check_face_regions(regions); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--face: ", status.message()));
  }
  return regions;
}

}  // namespace tet
