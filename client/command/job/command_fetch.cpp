// `tetstream job fetch`
#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/strip.h>

#include "client/command/job/follow_jobs.h"
#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/mesh/finish_mesh.h"
#include "client/command/mesh/mesh_report.h"
#include "client/command/process/stopwatch.h"
#include "client/library/stream_checks.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/printable.h"
#include "core/base/utf8.h"
#include "core/files/mesh_file.h"
#include "core/files/parts_file.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFetchExamples = R"(
The same bytes as of `tetstream mesh`. A .vtkhdf file is put together from ranges that are read side by
side, and the mesh is never in memory; the other formats need room for it. A connection that breaks is taken up at the first chunk that
is missing. In a folder the files are called NAME-ID; those that are there already are not fetched
again, so that the same command again fetches the rest.

Examples:
  tetstream job fetch jobs/019310c2a5d84f6b8e7a2c11 -o bunny.vtu --server farm:7447
  tetstream job fetch --label night=monday --into meshes --server farm:7447
  tetstream job fetch --label night=monday --into meshes --format msh --wait --server farm:7447
      each when it is finished
)";

struct FetchArguments {
  SessionArguments session;
  SelectionArguments selection;
  std::string output, folder, format;
  bool wait = false;
  int streams = 4;
};

void describe_options(CLI::App& app, FetchArguments& arguments) {
  app.footer(kFetchExamples);
  describe_selection(app, arguments.selection);
  auto* const output =
      app.add_option("-o,--output", arguments.output,
                     absl::StrCat("The mesh file of one job: ", list_endings("or")));
  auto* const folder = app.add_option("--into", arguments.folder,
                                      "Folder for a mesh file of each job; made when missing");
  output->excludes(folder);
  app.add_option("--format", arguments.format,
                 "Of the files in a folder [vtu], or of one whose ending does not say")
      ->check(CLI::IsMember(mesh_format_names()));
  app.add_option("--streams", arguments.streams,
                 "Ranges of a mesh that are read side by side, into .vtkhdf [4]")
      ->check(CLI::Range(1, 64));
  app.add_flag("--wait", arguments.wait, "Wait for jobs that are not finished");
  describe_session(app, arguments.session);
}

/// Names the file of a job: in any script, without what a file's name cannot hold or a shell
/// reads otherwise, and not hidden.
std::string file_stem(const v1::Job& job) {
  const std::string id(absl::StripPrefix(job.name(), "jobs/"));
  std::string name = cut_utf8(job.display_name(), 100);
  name = name.empty() ? id : absl::StrCat(name, "-", id);
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) {
        const bool is_ascii = c < 0x80;
        return is_ascii && !absl::ascii_isalnum(c) && c != '-' && c != '_' && c != '.';
      },
      '_');
  if (!name.empty() && name.front() == '.') name.front() = '_';
  return name;
}

/// Whether the reply is about the job that was asked for. Errors: kDataLoss.
absl::Status check_same_job(const v1::Job& job, const std::string& asked) {
  if (job.name() == asked) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("the server sent job '", for_terminal(job.name()),
                                          "' where ", for_terminal(asked), " was asked for"));
}

/// Where the mesh of a job goes, and as what.
absl::StatusOr<MeshOutput> output_for(const FetchArguments& arguments, const v1::Job& job) {
  if (!arguments.output.empty()) return mesh_output(arguments.output, arguments.format);
  const auto format =
      mesh_format_named(arguments.format.empty() ? "vtu" : std::string_view(arguments.format));
  if (!format.ok()) return format.status();
  const std::string name = file_stem(job) + std::string(row_of(*format).ending);
  return MeshOutput{fs::path(arguments.folder) / name, *format};
}

class Fetcher {
 public:
  Fetcher(JobSession& session,
          const FetchArguments& arguments,
          const Cancellation& cancellation)
      : session_(session), arguments_(arguments), cancellation_(cancellation) {}

  absl::Status fetch(const std::string& name) {
    if (arguments_.wait) {
      if (absl::Status status = wait_for(name); !status.ok()) return status;
    }
    const auto job = session_.jobs.get(name, cancellation_);
    if (!job.ok()) return job.status();
    if (auto status = check_same_job(*job, name); !status.ok()) return status;
    const auto output = output_for(arguments_, *job);
    if (!output.ok()) return output.status();
    if (arguments_.output.empty() && fs::exists(output->path)) {
      tell(*job, output->path, "fetched before", true);
      return absl::OkStatus();
    }
    return output->format == MeshFormat::kVtkHdf ? assemble(*job, *output)
                                                 : write(*job, *output);
  }

 private:
  absl::Status wait_for(const std::string& name) {
    session_.bar.begin("waiting");
    const FollowWatch watch{.finished = [](const v1::Job&) {},
                            .progress = [&](double jobs) { session_.bar.update(jobs, 1); }};
    return follow_jobs(session_.jobs, {name}, watch, cancellation_);
  }

  absl::Status write(const v1::Job& job, const MeshOutput& output) {
    const Stopwatch watch;
    session_.bar.begin("receiving", "tets");
    auto streamed = session_.jobs.read_result(job.name(), receiving(), cancellation_);
    if (!streamed.ok()) return streamed.status();
    MadeMesh made = made_of(*std::move(streamed), {});
    absl::Status status = write_made_mesh(output, made, session_.bar, cancellation_);
    if (!status.ok()) return status;
    tell(job, output.path, summary_line(output.path, made, watch.seconds()), false);
    note_guess(made.mesh.header);
    for (const std::string& warning : face_warnings(made.mesh)) {
      session_.bar.say_lines("warning: " + for_terminal(warning), stderr);
    }
    return absl::OkStatus();
  }

  /// Each chunk goes to its place in the file as it comes: the mesh is never in memory.
  absl::Status assemble(const v1::Job& job, const MeshOutput& output) {
    const Stopwatch watch;
    if (job.state() != v1::JOB_STATE_SUCCEEDED)
      return write(job, output);  // which says why not
    const auto header = checked_header(job.header());
    if (!header.ok()) return header.status();
    const std::string& path = output.path;
    auto file = PartsFile::create(output, *header, cancellation_);
    if (!file.ok()) return file.status();
    session_.bar.begin("receiving", "tets");
    absl::Status status = session_.jobs.read_parts(
        job, arguments_.streams,
        [&](const TetMesh& part, const ChunkExtent& place) { return file->put(part, place); },
        receiving(), cancellation_);
    if (status.ok()) status = file->commit();
    if (!status.ok()) return status;
    tell(job, path,
         absl::StrFormat("%s: %d vertices, %d tets, %.2f s", path, header->vertex_count,
                         header->tet_count, watch.seconds()),
         false);
    note_guess(*header);
    return absl::OkStatus();
  }

  void note_guess(const MeshHeader& header) {
    if (!header.inside_guess.empty())
      session_.bar.say_lines(inside_note(header.inside_guess), stderr);
  }

  ClientProgress receiving() {
    return {
        .upload = {}, .planning = {}, .tets = [this](std::uint64_t done, std::uint64_t total) {
          session_.bar.update(static_cast<double>(done), static_cast<double>(total));
        }};
  }

  void tell(const v1::Job& job, const std::string& path, const std::string& text, bool before) {
    session_.print({{"name", job.name()}, {"file", path}, {"fetched_before", before}},
                   for_terminal(before ? absl::StrCat(path, ": ", text) : text));
  }

  JobSession& session_;
  const FetchArguments& arguments_;
  const Cancellation& cancellation_;
};

/// All that can be refused before anything is fetched.
absl::Status prepare(const FetchArguments& arguments) {
  if (!arguments.output.empty()) {
    const auto output = mesh_output(arguments.output, arguments.format);
    return output.ok() ? check_can_write(*output) : output.status();
  }
  if (arguments.folder.empty())
    return absl::InvalidArgumentError("say where to: -o FILE for one job, or --into FOLDER");
  std::error_code error;
  fs::create_directories(arguments.folder, error);
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("cannot make ", arguments.folder, ": ", error.message()));
}

absl::Status run_fetch(const FetchArguments& arguments, const Cancellation& interruption) {
  if (absl::Status status = prepare(arguments); !status.ok()) return status;
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  auto names = select_jobs((*session)->jobs, arguments.selection, interruption);
  if (!names.ok()) return names.status();
  if (auto status = check_any(*names, arguments.selection); !status.ok()) return status;
  if (!arguments.output.empty() && names->size() != 1) {
    return absl::InvalidArgumentError(absl::StrCat("-o is for one job, and these are ",
                                                   names->size(), ": use --into FOLDER"));
  }
  Fetcher fetcher(**session, arguments, interruption);
  return for_each_of(
      **session, *names, [&](const std::string& name) { return fetcher.fetch(name); },
      interruption);
}

}  // namespace

Command add_fetch_command(CLI::App& app) {
  const auto arguments = std::make_shared<FetchArguments>();
  describe_options(app, *arguments);
  return [arguments](const Cancellation& interruption) {
    return run_fetch(*arguments, interruption);
  };
}

}  // namespace tet
