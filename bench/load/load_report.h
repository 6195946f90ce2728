// A run's figures, for people and for programs. docs/load.md says how to read both.
#pragma once

#include <string>
#include <vector>

#include "bench/load/latency_goal.h"
#include "bench/load/request_mix.h"
#include "bench/load/run_load.h"
#include "bench/load/search_load.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

namespace v1 = ::tetstream::v1;

/// What every report of a session begins with.
struct LoadSetting {
  std::string server;
  std::string started;  ///< UTC, ISO 8601
  std::vector<MixEntry> mix;
  std::vector<LatencyGoal> goals;
  v1::Encoding encoding = v1::ENCODING_PLAIN;  ///< of the streams
};

/// "plain", "packed" or "compact".
std::string encoding_name(v1::Encoding encoding);

/// "Poisson arrivals at 20/s", "3 workers back to back", ...
std::string describe_plan(const LoadPlan& plan);

/// Lines for a reader, the last of them warnings.
std::string report_text(const LoadSetting& setting, const LoadResult& result);
/// One JSON object.
std::string report_json(const LoadSetting& setting, const LoadResult& result);

/// The answer of a search first, then a run at that rate.
std::string search_text(const LoadSetting& setting, const LoadSearch& found);
std::string search_json(const LoadSetting& setting, const LoadSearch& found);

/// One line for one trial.
std::string trial_line(const Trial& trial);

}  // namespace tet::load
