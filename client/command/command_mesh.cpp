// `tetstream mesh`: a volume, a closed surface or a scene in, a mesh file out.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/cord.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "client/command/arguments/mesh_arguments.h"
#include "client/command/arguments/output_places.h"
#include "client/command/arguments/placed_array.h"
#include "client/command/arguments/scene_input.h"
#include "client/command/arguments/volume_file.h"
#include "client/command/command.h"
#include "client/command/mesh/finish_mesh.h"
#include "client/command/mesh/label_report.h"
#include "client/command/mesh/mesh_maker.h"
#include "client/command/mesh/mesh_report.h"
#include "client/command/mesh/use_shape.h"
#include "client/command/process/stopwatch.h"
#include "core/base/parallel.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/printable.h"
#include "core/files/mesh_file.h"
#include "core/volume/inside.h"

namespace tet {
namespace {

constexpr const char* kMeshExamples = R"(
Examples:
  tetstream mesh bunny.vdb -o bunny.vtu
      graded: finest at the surface, coarser inside
  tetstream mesh bunny.vdb -o bunny.msh --levels 0
      uniform: every tet of the finest size
  tetstream mesh bunny.vdb -o bunny.vtu --improve --report bunny.json
      better worst angles, and a report on how much better
  tetstream mesh smoke.vdb -o smoke.vtkhdf --grid density --iso 0.2 --spacing 0.5
      one grid of several, at another density and another size of tets
  tetstream mesh body.vdb -o leg.vtu --grid femur --grid tibia
      two grids, each meshed by itself, in one file; the cells' `part` is 1 and 2. --all-grids takes
      every grid that can be meshed: docs/several_grids.md
  tetstream mesh bunny.vdb -o bunny.vtu --preset both-sides --box -3 -3 -3 3 3 3
      the bunny and the space around it in one mesh, up to a box; the cells' `region` is
      1 inside and 2 outside
  tetstream mesh bunny.vdb -o part.msh --box -2 0 -2 2 3 2
      the part of the inside that lies in a box, with flat, labelled faces where it cuts;
      docs/cuts.md
  tetstream mesh docs/scenes/bracket.json -o bracket.inp --face bore=node:bore
      the faces that a node of the scene made, by a name of their own; docs/faces.md
  tetstream mesh head.nii.gz --labels all --label-names labels.txt -o head.vtu
      every label of a segmentation in one mesh with shared interfaces; docs/labels.md
  tetstream mesh bunny.vdb -o bunny.inp
      element sets, node sets and surfaces for CalculiX and Abaqus; docs/formats.md has all formats
  tetstream mesh thin.vdb -o thin.msh --manifold
      a boundary that touches itself nowhere, however thin the walls
  tetstream mesh part.stl -o part.vtu --voxel 0.1
      a closed surface; it becomes a level set with voxels of 0.1 first
  tetstream mesh scan.ply -o scan.vtu --open close
      a surface with holes, which get caps
  tetstream mesh part.json -o part.vtu --spacing 0.05
      a scene: solids as formulas, and grids, put together; docs/scenes.md
  tetstream mesh bunny.vdb -o bunny.vtu --sizing '{"growth": 0.25, "coarsest": 0.4}'
      smaller tets inside; docs/sizing.md
  tetstream mesh bunny.vdb -o bunny.vtu --sizing '{"coarsest": 0.2, "grade_surface": true}'
      larger ones at the surface, too
  tetstream mesh fire.vdb -o fire.vtu --grid density --field temperature --field v=flow.vdb:vel
      the values of other grids at the vertices, as named arrays; docs/fields.md
  tetstream mesh bunny.vdb -o bunny.msh --order 2
      tets of ten nodes whose faces follow the surface; docs/second_order.md
  tetstream mesh bunny.vdb -o bunny.vtu --levels 0 --skip-statistics
      the mesh and no more, when there are many to make
  tetstream mesh bunny.vdb -o bunny.vtu --server localhost:7447 --report bunny.json
      the same bytes from a server, and a report on angles, times and the boundary
)";

void describe_options(CLI::App& app, MeshArguments& arguments) {
  MeshOptions& options = arguments.options;
  app.footer(kMeshExamples);
  app.add_option("-o,--output", options.output,
                 absl::StrCat("The mesh file: ", list_endings("or"), "; see tetstream formats"))
      ->required();
  app.add_option("--format", options.format, "Of the mesh file, where its ending does not say")
      ->check(CLI::IsMember(mesh_format_names()));
  describe_input(app, arguments);
  auto* const packed = app.add_flag(
      "--packed", options.packed,
      "Receive four bytes a tet, not eighteen, of any mesh, which the server packs");
  app.add_flag("--compact", options.compact,
               "Receive half a byte a tet and make the mesh here: for networks below 10 Gbit/s")
      ->excludes(packed);
  app.add_flag("--skip-cache", options.skip_cache,
               "Have a server make the mesh though it has it as a job's result");
  app.add_option("--order", options.order,
                 "2 gives each tet ten nodes, those between the surface's on the surface: "
                 "docs/second_order.md [1]")
      ->check(CLI::Range(1, 2));
  auto* const report =
      app.add_option("--report", options.report,
                     "JSON file for counts, times, angles, shapes, boundary, regions, "
                     "and how far the surface is from the true one: docs/report.md");
  app.add_flag("--skip-statistics", arguments.request.request.skip_statistics,
               "Neither measure angles nor count the boundary: the same mesh, sooner")
      ->excludes(report);
}

absl::Status check_encoding(const MeshOptions& options) {
  if ((options.compact || options.packed) && options.server.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(options.compact ? "--compact" : "--packed",
                     " is about what a server sends: add --server"));
  }
  return absl::OkStatus();
}

/// Order 2 bends edges onto one surface.
absl::Status check_order(const MeshOptions& options) {
  if (options.order == 1 || !options.request.labels) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "--order 2 does not go with --labels: leave one of them out");
}

absl::Status check_cache(const MeshOptions& options) {
  if (!options.skip_cache || !options.server.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError("--skip-cache is about a server's results: add --server");
}

absl::Status check_output(const MeshOptions& options) {
  const auto output = mesh_output(options.output, options.format);
  if (!output.ok()) return output.status();
  if (options.order > 1) {
    if (auto status = check_takes_second_order(*output); !status.ok()) return status;
  }
  return check_can_write(*output);
}

/// All that can be refused before hours of work.
absl::Status check_options(const MeshArguments& arguments, const MeshOptions& options) {
  absl::Status status = check_input(options);
  if (status.ok()) status = check_encoding(options);
  if (status.ok()) status = check_cache(options);
  if (status.ok()) status = check_order(options);
  if (status.ok()) status = check_output(options);
  if (status.ok()) status = check_output_places(arguments, options);
  return status;
}

absl::StatusOr<MadeMesh> make_mesh(const MeshOptions& options,
                                   ProgressBar& bar,
                                   const Cancellation& interruption) {
  return options.server.empty() ? make_mesh_here(options, bar, interruption)
                                : make_mesh_on_server(options, bar, interruption);
}

/// An image that does not say what is inside may be a segmentation.
absl::Status with_hint_of_labels(const MeshOptions& options, const absl::Status& status) {
  const bool may_have_labels = is_volume_file(options.input) &&
                               !absl::EndsWithIgnoreCase(options.input, ".vdb") &&
                               absl::StartsWith(status.message(), kInsideField);
  if (!may_have_labels || !absl::IsInvalidArgument(status)) return status;
  absl::Status hinted(
      status.code(), absl::StrCat(status.message(),
                                  "; if it is a segmentation, mesh its labels (--labels all)"));
  status.ForEachPayload(
      [&](auto url, const absl::Cord& payload) { hinted.SetPayload(url, payload); });
  return hinted;
}

/// The shape is of no more use.
void let_shape_go(MadeMesh& made) {
  made.shape.reset();
  made.fields.clear();
}

/// Does what the mesh's file needs the shape for, and writes it.
absl::Status write_mesh(const MeshOptions& options,
                        MadeMesh& made,
                        ProgressBar& bar,
                        const Cancellation& interruption) {
  absl::Status status;
  if (options.order > 1) status = add_middle_nodes(options, made, bar, interruption);
  if (options.report.empty()) let_shape_go(made);
  if (!status.ok()) return status;
  const auto output = mesh_output(options.output, options.format);
  if (!output.ok()) return output.status();
  return write_made_mesh(*output, made, bar, interruption);
}

/// Measures for the report what takes the shape. That is as long as meshing and takes memory of
/// its own: the mesh, which may be of hours, has its file before.
absl::Status measure_for_report(const MeshOptions& options,
                                MadeMesh& made,
                                ProgressBar& bar,
                                const Cancellation& interruption) {
  if (options.report.empty()) return absl::OkStatus();
  const absl::Status status = options.request.labels
                                  ? add_voxel_volumes(options, made, bar, interruption)
                                  : check_fidelity(options, made, bar, interruption);
  let_shape_go(made);
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(status.message(), "; ", options.output,
                                                  " is there, but no report"));
}

absl::Status run_mesh(const MeshArguments& arguments, const Cancellation& interruption) {
  const Stopwatch watch;
  absl::StatusOr<MeshOptions> options = understand_input(arguments);
  if (!options.ok()) return options.status();
  if (auto status = check_options(arguments, *options); !status.ok()) return status;
  const absl::StatusOr<PlacedArray> placed = PlacedArray::of(*options, interruption);
  if (!placed.ok()) return placed.status();

  // What writes and reports has loops of its own, which would take every core by themselves.
  TaskPool pool(options->threads);
  absl::StatusOr<MadeMesh> made = absl::UnknownError("not made");
  {
    ProgressBar bar;
    made = make_mesh(*options, bar, interruption);
    if (!made.ok()) return with_hint_of_labels(*options, made.status());
    made->cuts_inside = options->request.box || options->request.iso;
    absl::Status written;
    pool.run([&] { written = write_mesh(*options, *made, bar, interruption); });
    if (!written.ok()) return written;
    const absl::Status measured = measure_for_report(*options, *made, bar, interruption);
    if (!measured.ok()) return measured;
  }
  const double seconds = watch.seconds();
  if (!options->report.empty()) {
    std::string report;
    pool.run([&] { report = report_json(*made, options->request, seconds); });
    if (auto status = write_text_file(options->report, report); !status.ok()) return status;
  }
  std::printf("%s\n", for_terminal(summary_line(options->output, *made, seconds)).c_str());
  if (!made->mesh.header.inside_guess.empty()) {
    std::fprintf(stderr, "%s\n",
                 lines_for_terminal(inside_note(made->mesh.header.inside_guess)).c_str());
  }
  if (made->mesh.header.box) {
    std::fprintf(stderr, "%s\n", box_note(*made->mesh.header.box).c_str());
  }
  if (made->thin_walls.any()) {
    std::fprintf(stderr, "%s\n", thin_walls_warning(made->thin_walls).c_str());
  }
  for (const std::string& warning : face_warnings(made->mesh)) {
    std::fprintf(stderr, "warning: %s\n", for_terminal(warning).c_str());
  }
  const bool is_of_solids = options->has_several_grids() || is_scene_file(options->input);
  const LabelOrigin origin = is_of_solids ? LabelOrigin::kSolids : LabelOrigin::kVoxels;
  if (const std::string lost = lost_labels_warning(*made, origin); !lost.empty()) {
    std::fprintf(stderr, "%s\n", lines_for_terminal(lost).c_str());
  }
  if (const std::string warning = volume_warning(*made); !warning.empty()) {
    std::fprintf(stderr, "warning: %s\n", for_terminal(warning).c_str());
  }
  return absl::OkStatus();
}

}  // namespace

Command add_mesh_command(CLI::App& app) {
  const auto arguments = std::make_shared<MeshArguments>();
  describe_options(app, *arguments);
  return [arguments](const Cancellation& interruption) {
    return run_mesh(*arguments, interruption);
  };
}

}  // namespace tet
