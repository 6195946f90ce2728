#include "client/command/job/job_order.h"

#include <filesystem>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>
#include <absl/time/time.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "client/command/arguments/field_options.h"
#include "client/command/arguments/option_rules.h"
#include "client/library/wire_request.h"
#include "proto/convert/times.h"
#include "proto/wire/sha256.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGroup = "Job";
constexpr absl::Duration kLongest = absl::Hours(24 * 365 * 100);  ///< as servers have it

absl::StatusOr<google::protobuf::Duration> parse_duration(const char* option,
                                                          const std::string& text) {
  absl::Duration time;
  if (!absl::ParseDuration(text, &time) || time <= absl::ZeroDuration()) {
    return absl::InvalidArgumentError(
        absl::StrCat(option, " ", text, " is not a time such as 90s, 30m or 12h"));
  }
  if (time > kLongest) {
    return absl::InvalidArgumentError(
        absl::StrCat(option, " ", text, " is more than ", absl::FormatDuration(kLongest),
                     ", a hundred years: leave it out for no end"));
  }
  return to_proto(time);
}

absl::Status set_times(const JobArguments& arguments, v1::Job& job) {
  if (!arguments.ttl.empty()) {
    auto ttl = parse_duration("--ttl", arguments.ttl);
    if (!ttl.ok()) return ttl.status();
    *job.mutable_ttl() = *std::move(ttl);
  }
  if (!arguments.timeout.empty()) {
    auto timeout = parse_duration("--timeout", arguments.timeout);
    if (!timeout.ok()) return timeout.status();
    *job.mutable_timeout() = *std::move(timeout);
  }
  return absl::OkStatus();
}

absl::Status set_labels(const std::vector<std::string>& labels, v1::Job& job) {
  for (const std::string& label : labels) {
    const std::pair<std::string, std::string> parts =
        absl::StrSplit(label, absl::MaxSplits('=', 1));
    if (label.find('=') == std::string::npos || parts.first.empty()) {
      return absl::InvalidArgumentError(absl::StrCat("--label ", label, " is not KEY=VALUE"));
    }
    (*job.mutable_labels())[parts.first] = parts.second;
  }
  return absl::OkStatus();
}

std::string default_name(const std::string& input) {
  return stored_grid_name(input).empty() ? fs::path(input).stem().string() : "";
}

/// Names a file so that it does not matter where the command is run: by a stored file's name,
/// or by where the file lies. An empty path stays empty.
std::string place_of(const std::string& path) {
  if (path.empty()) return path;
  const std::string stored = stored_grid_name(path);
  return stored.empty() ? fs::absolute(path).lexically_normal().string() : stored;
}

std::string deterministic_bytes(const v1::Job& job) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);  // labels are a map
  job.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

}  // namespace

void describe_job(CLI::App& app, JobArguments& arguments) {
  describe_request(app, arguments.request);
  describe_surface(app, arguments.surface);
  app.add_option("--name", arguments.name, "What people call the job [the file's name]")
      ->group(kGroup);
  app.add_option("--label", arguments.labels, "To find the job by; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->group(kGroup);
  app.add_option("--priority", arguments.priority, "-100 to 100; higher ones come first [0]")
      ->group(kGroup);
  app.add_option("--ttl", arguments.ttl, "Expires when it is not finished by then [never]")
      ->type_name("TIME")
      ->group(kGroup);
  app.add_option("--timeout", arguments.timeout, "Fails when it runs for longer [never]")
      ->type_name("TIME")
      ->group(kGroup);
  app.add_option("--max-attempts", arguments.max_attempts,
                 "How often a part of it is tried, 1 to 100 [3]")
      ->group(kGroup);
  app.add_flag("--skip-cache", arguments.skip_cache,
               "Make the mesh even where its result is stored")
      ->group(kGroup);
}

absl::StatusOr<JobOrder> understand_job(const JobArguments& arguments) {
  absl::StatusOr<MeshRequest> request = understand_request(arguments.request);
  if (!request.ok()) return request.status();
  JobOrder order{{arguments.input, arguments.request.grids, arguments.surface}, {}};
  for (VertexField& field : request->fields) field.file = place_of(field.file);
  v1::Job& job = order.job;
  *job.mutable_mesh() = wire_request(*request, "", arguments.request.grids);
  job.set_display_name(arguments.name.empty() ? default_name(arguments.input) : arguments.name);
  job.set_priority(arguments.priority);
  if (arguments.max_attempts) job.set_max_attempts(*arguments.max_attempts);
  job.set_skip_cache(arguments.skip_cache);
  absl::Status status = check_rules(*request, order.input);
  if (status.ok()) status = check_field_files(request->fields, arguments.input);
  if (status.ok()) status = set_times(arguments, job);
  if (status.ok()) status = set_labels(arguments.labels, job);
  if (status.ok() && stored_grid_name(order.input.path).empty()) {
    status = check_mesh_input(order.input);
  }
  if (!status.ok()) return status;
  return order;
}

std::string digest_of(const JobOrder& order) {
  const std::string place = place_of(order.input.path);
  Sha256 digest;
  digest.add(absl::StrCat(place.size(), ":", place));
  digest.add(absl::StrFormat("%a:", order.input.surface.voxel.value_or(0)));
  // It adds nothing where it is not said, so that orders of earlier versions are known again.
  if (const auto& open = order.input.surface.open) {
    digest.add(absl::StrFormat("%d:", static_cast<int>(*open)));
  }
  digest.add(deterministic_bytes(order.job));
  return digest.finish_hex();
}

}  // namespace tet
