#include <algorithm>
#include <utility>

#include <google/protobuf/util/json_util.h>
#include <nlohmann/json.hpp>

#include "bench/load/load_report.h"
#include "bench/load/quantiles.h"
#include "bench/load/verdict.h"

namespace tet::load {
namespace {

using Json = nlohmann::ordered_json;

/// Goes up when a key changes its meaning or goes.
constexpr int kSchema = 1;

Json latency_json(const LatencyHistogram& latencies) {
  Json json{{"count", latencies.count()}};
  for (const Quantile& quantile : kQuantiles) {
    json[quantile.key] = to_ms(latencies.quantile(quantile.fraction));
  }
  json["max"] = to_ms(latencies.max());
  json["mean"] = to_ms(latencies.mean());
  return json;
}

Json errors_json(const Tally& tally) {
  Json json = Json::object();
  for (const auto& [code, count] : tally.errors) {
    json[absl::StatusCodeToString(code)] = {{"count", count},
                                            {"message", tally.error_messages.at(code)}};
  }
  return json;
}

Json tally_json(const Tally& tally) {
  Json json;
  json["requests"] = {{"offered", tally.offered}, {"done", tally.done},
                      {"failed", tally.failed},   {"unfinished", tally.unfinished},
                      {"dropped", tally.dropped}, {"queued", tally.queued}};
  json["errors"] = errors_json(tally);
  json["latency_ms"] = {{"header", latency_json(tally.latency(LatencyKind::kHeader))},
                        {"first_chunk", latency_json(tally.latency(LatencyKind::kFirstChunk))},
                        {"whole", latency_json(tally.latency(LatencyKind::kWhole))}};
  return json;
}

Json message_json(const tetstream::v1::MeshRequest& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
  return status.ok() ? Json::parse(text) : Json(nullptr);
}

Json mix_json(const std::vector<MixEntry>& mix) {
  Json json = Json::array();
  for (const MixEntry& entry : mix) {
    Json one{{"label", entry.label},
             {"weight", entry.weight},
             {"request", message_json(entry.message)},
             {"tets", entry.tet_count},
             {"fresh", entry.fresh},
             {"kind", entry.kind == RequestKind::kJob ? "job" : "stream"}};
    one["skip_cache"] = entry.skip_cache;
    if (entry.fresh) one["fresh_from"] = entry.fresh_from;
    if (entry.iso) one["iso_range"] = {entry.iso->low, entry.iso->high};
    json.push_back(std::move(one));
  }
  return json;
}

Json plan_json(const LoadPlan& plan) {
  Json json;
  if (plan.workers > 0) {
    json["mode"] = "workers";
    json["workers"] = plan.workers;
  } else {
    json["mode"] = "open";
    json["arrivals"] = plan.process == ArrivalProcess::kPoisson ? "poisson" : "constant";
    json["burst"] = plan.burst;
  }
  json["steps"] = Json::array();
  for (const RateStep& step : plan.steps) {
    Json one;
    if (plan.workers == 0) one["per_second"] = step.per_second;
    one["seconds"] = step.seconds;
    json["steps"].push_back(std::move(one));
  }
  json["warm_up_seconds"] = plan.warm_up_seconds;
  json["max_outstanding"] = plan.max_outstanding;
  json["max_queued"] = plan.max_queued;
  if (plan.timeout) json["timeout_ms"] = to_ms(*plan.timeout);
  json["seed"] = plan.seed;
  return json;
}

Json rates_json(const LoadResult& result) {
  const double seconds = std::max(result.window.seconds, 1e-9);
  const auto per_second = [&](std::uint64_t count) {
    return static_cast<double>(count) / seconds;
  };
  return {{"seconds", result.window.seconds},
          {"offered_s", per_second(result.total.offered)},
          {"done_s", per_second(result.total.done)},
          {"tets_s", per_second(result.window.received.tets)},
          {"bytes_s", per_second(result.window.received.bytes)}};
}

Json generator_json(const LoadResult& result) {
  const GeneratorState state = generator_state(result);
  return {{"late_ms", latency_json(result.total.lateness)},
          {"cores_used", state.cores_used},
          {"cores", state.cores}};
}

Json goals_json(const LoadSetting& setting, const LoadResult& result) {
  Json json = Json::array();
  for (const LatencyGoal& goal : setting.goals) {
    json.push_back({{"target", show_goal(goal)},
                    {"held", result.total.holds(goal)},
                    {"missed", result.total.missed(goal)}});
  }
  return json;
}

Json parts_json(const LoadSetting& setting, const LoadResult& result, Json json) {
  json["by_step"] = Json::array();
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    Json step = tally_json(result.steps[i]);
    if (result.plan.workers == 0) step["per_second"] = result.plan.steps[i].per_second;
    json["by_step"].push_back(std::move(step));
  }
  json["by_request"] = Json::array();
  for (std::size_t i = 0; i < result.entries.size(); ++i) {
    Json entry = tally_json(result.entries[i]);
    entry["label"] = setting.mix[i].label;
    json["by_request"].push_back(std::move(entry));
  }
  return json;
}

Json run_json(const LoadSetting& setting, const LoadResult& result) {
  Json json{{"plan", plan_json(result.plan)}, {"rates", rates_json(result)}};
  json.update(tally_json(result.total));
  json["generator"] = generator_json(result);
  json["targets"] = goals_json(setting, result);
  json["interrupted"] = result.interrupted;
  json["notes"] = warnings_of(result, setting.goals);
  return parts_json(setting, result, std::move(json));
}

Json setting_json(const LoadSetting& setting) {
  return {{"schema", kSchema},
          {"server", setting.server},
          {"started", setting.started},
          {"encoding", encoding_name(setting.encoding)},
          {"mix", mix_json(setting.mix)}};
}

Json optional_json(const std::optional<double>& number) {
  return number ? Json(*number) : Json(nullptr);
}

Json answer_json(const LoadSetting& setting, const SearchResult& search) {
  Json goals = Json::array();
  for (const LatencyGoal& goal : setting.goals) goals.push_back(show_goal(goal));
  return {{"targets", std::move(goals)},
          {"per_second", optional_json(search.per_second)},
          {"failed_per_second", optional_json(search.failed_per_second)},
          {"limited_by", name_of(search.limited_by)},
          {"trials", search.trials},
          {"held", search.held},
          {"requests", search.requests},
          {"missed", search.missed},
          {"missed_share_95", {search.missed_share.low, search.missed_share.high}},
          {"interrupted", search.interrupted}};
}

/// Text may come from files and servers and need not be UTF-8.
std::string dump(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string report_json(const LoadSetting& setting, const LoadResult& result) {
  Json json = setting_json(setting);
  json.update(run_json(setting, result));
  return dump(json);
}

std::string search_json(const LoadSetting& setting, const LoadSearch& found) {
  Json json = setting_json(setting);
  json["search"] = answer_json(setting, found.search);
  json["trials"] = Json::array();
  for (const Trial& trial : found.search.all) {
    json["trials"].push_back({{"per_second", trial.per_second},
                              {"verdict", name_of(trial.verdict)},
                              {"requests", trial.requests},
                              {"missed", trial.missed}});
  }
  json["alone"] = found.alone ? run_json(setting, *found.alone) : Json(nullptr);
  json["best"] = found.best ? run_json(setting, *found.best) : Json(nullptr);
  return dump(json);
}

}  // namespace tet::load
