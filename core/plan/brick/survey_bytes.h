// A survey as bytes, for hosts that share one: what counting needs of it, without the geometry.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/plan/brick/survey.h"

namespace tet {

/// Writes the same bytes for the same survey on any machine of this byte order: 230 to 820 a
/// brick. The survey has no restored nodes. `candidates` are what was surveyed.
std::vector<std::byte> write_survey(const Survey& survey,
                                    const std::vector<BrickCoord>& candidates);

/// Reads what was written of a survey of `candidates`. Returns nothing where the bytes are not
/// those of such a survey.
std::optional<Survey> read_survey(std::span<const std::byte> bytes,
                                  const std::vector<BrickCoord>& candidates,
                                  bool both_sides);

}  // namespace tet
