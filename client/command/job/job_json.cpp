#include "client/command/job/job_json.h"

#include <google/protobuf/util/json_util.h>

#include "client/library/error_details.h"
#include "proto/convert/times.h"

namespace tet {
namespace {

using Json = nlohmann::ordered_json;

double seconds_of(const google::protobuf::Duration& duration) {
  return static_cast<double>(duration.seconds()) + 1e-9 * duration.nanos();
}

Json request_json(const v1::MeshRequest& mesh) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(mesh, &text, options);
  return status.ok() ? Json::parse(text) : Json(nullptr);
}

Json labels_json(const v1::Job& job) {
  const std::map<std::string, std::string> sorted(job.labels().begin(), job.labels().end());
  return Json(sorted);
}

Json progress_json(const v1::JobProgress& progress) {
  Json json{{"chunk_count", progress.chunk_count()},
            {"done_chunks", progress.done_chunks()},
            {"shard_count", progress.shard_count()},
            {"done_shards", progress.done_shards()},
            {"running_shards", progress.running_shards()},
            {"dead_shards", progress.dead_shards()},
            {"chunks_per_second", progress.chunks_per_second()}};
  if (progress.has_eta()) json["eta_seconds"] = seconds_of(progress.eta());
  return json;
}

void add_times(const v1::Job& job, Json& json) {
  if (job.has_create_time()) json["create_time"] = text_of(job.create_time());
  if (job.has_start_time()) json["start_time"] = text_of(job.start_time());
  if (job.has_finish_time()) json["finish_time"] = text_of(job.finish_time());
  if (job.has_stop_time()) json["stop_time"] = text_of(job.stop_time());
  if (job.has_ttl()) json["ttl_seconds"] = seconds_of(job.ttl());
  if (job.has_timeout()) json["timeout_seconds"] = seconds_of(job.timeout());
}

Json header_json(const v1::MeshHeader& header) {
  return {{"mesh_id", header.mesh_id()},
          {"vertices", header.vertex_count()},
          {"tets", header.tet_count()},
          {"chunks", header.chunk_count()}};
}

/// An enumerator without what it shares with all others.
std::string without_prefix(const std::string& name, std::string_view prefix) {
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

}  // namespace

std::string name_of(v1::JobState state) {
  return without_prefix(v1::JobState_Name(state), "JOB_STATE_");
}

std::string name_of(v1::JobChange change) {
  return without_prefix(v1::JobChange_Name(change), "JOB_CHANGE_");
}

bool is_final(v1::JobState state) {
  return state != v1::JOB_STATE_UNSPECIFIED && state != v1::JOB_STATE_QUEUED &&
         state != v1::JOB_STATE_RUNNING;
}

Json as_json(const absl::Status& error) {
  return {{"code", absl::StatusCodeToString(error.code())},
          {"reason", reason_of_failure(error)},
          {"message", std::string(error.message())}};
}

Json as_json(const v1::Job& job) {
  Json json{{"name", job.name()},
            {"state", name_of(job.state())},
            {"display_name", job.display_name()},
            {"labels", labels_json(job)},
            {"priority", job.priority()}};
  add_times(job, json);
  if (job.has_max_attempts()) json["max_attempts"] = job.max_attempts();
  json["skip_cache"] = job.skip_cache();
  json["cached"] = job.cached();
  if (job.has_queue_position()) json["queue_position"] = job.queue_position();
  json["progress"] = progress_json(job.progress());
  json["version"] = job.version();
  json["determinism_alarms"] = job.determinism_alarms();
  json["replans"] = job.replans();
  json["given_back_shards"] = job.given_back_shards();
  if (job.has_last_give_back()) {
    json["last_give_back"] = as_json(to_absl(job.last_give_back()));
  }
  if (job.has_error()) json["error"] = as_json(to_absl(job.error()));
  json["mesh"] = request_json(job.mesh());
  if (job.has_header()) json["header"] = header_json(job.header());
  return json;
}

Json as_json(const v1::JobEvent& event) {
  return {{"revision", event.revision()},
          {"time", text_of(event.time())},
          {"name", event.name()},
          {"version", event.version()},
          {"change", name_of(event.change())},
          {"state", name_of(event.state())},
          {"progress", progress_json(event.progress())}};
}

Json as_json(const v1::DeadShard& shard) {
  return {{"first_chunk", shard.first_chunk()},
          {"end_chunk", shard.end_chunk()},
          {"attempts", shard.attempts()},
          {"worker", shard.worker()},
          {"error", as_json(to_absl(shard.error()))},
          {"time", text_of(shard.time())}};
}

std::string state_of(const v1::Worker& worker) {
  if (worker.lost()) return "LOST";
  return worker.has_trouble() ? "QUARANTINED" : "WORKING";
}

Json as_json(const v1::Worker& worker) {
  Json json{{"name", worker.name()},
            {"algorithm_version", worker.algorithm_version()},
            {"state", state_of(worker)},
            {"seen_time", text_of(worker.seen_time())},
            {"leased_shards", worker.leased_shards()}};
  if (worker.has_trouble()) json["trouble"] = as_json(to_absl(worker.trouble()));
  json["shards"] = Json::array();
  for (const v1::LeasedShard& shard : worker.shards()) {
    json["shards"].push_back({{"job", shard.job()},
                              {"first_chunk", shard.first_chunk()},
                              {"end_chunk", shard.end_chunk()},
                              {"attempt", shard.attempt()},
                              {"lease_end_time", text_of(shard.lease_end_time())}});
  }
  return json;
}

std::string line_of(const Json& json) {
  constexpr bool kAscii = true;  // for a terminal: nothing in it acts
  return json.dump(-1, ' ', kAscii, Json::error_handler_t::replace);
}

}  // namespace tet
