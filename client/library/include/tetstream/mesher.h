// Meshes that are made in this process.
#pragma once

#include <cstdint>

#include "tetstream/export.h"
#include "tetstream/labels.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"
#include "tetstream/status.h"
#include "tetstream/stream.h"
#include "tetstream/volume.h"

namespace tetstream {

/// What a mesh would take, known without making it.
struct Estimate {
  std::uint64_t vertex_count = 0;
  std::uint64_t tet_count = 0;
  std::uint64_t chunk_count = 0;  ///< that a stream of it has
  std::uint64_t bytes = 0;        ///< of its arrays together
  double seconds = 0;             ///< about how long making it takes, once it is counted
};

// Any thread may call any of these at any time; each call has threads of its own, and waits for
// them. The same volume and request make the same bytes for any number of threads, here and on
// a server of the same version.
//
// Errors: kInvalidArgument (a field of the request, named in the message), kFailedPrecondition
// (no surface at this iso value, or an inside without an end), kResourceExhausted (too large),
// kCancelled, kDeadlineExceeded.

/// Makes a mesh.
TETSTREAM_API Result<Mesh> mesh(const Volume& volume,
                                const Request& request = {},
                                const WorkOptions& options = {});

TETSTREAM_API Result<Mesh> mesh(const Scene& scene,
                                const Request& request = {},
                                const WorkOptions& options = {});

/// Makes one mesh of all labels, which share the faces between them.
TETSTREAM_API Result<Mesh> mesh(const Labels& labels,
                                const Request& request = {},
                                const WorkOptions& options = {});

/// Counts a mesh without making it. `options.progress` is not called.
TETSTREAM_API Result<Estimate> estimate(const Volume& volume,
                                        const Request& request = {},
                                        const WorkOptions& options = {});

TETSTREAM_API Result<Estimate> estimate(const Scene& scene,
                                        const Request& request = {},
                                        const WorkOptions& options = {});
TETSTREAM_API Result<Estimate> estimate(const Labels& labels,
                                        const Request& request = {},
                                        const WorkOptions& options = {});

/// Makes a mesh chunk by chunk; nothing is done before the first call of a member. An improved
/// mesh and one that is cut by a box are made as a whole before their headers.
TETSTREAM_API MeshStream stream(const Volume& volume,
                                const Request& request = {},
                                const WorkOptions& options = {},
                                ChunkRange chunks = {});
TETSTREAM_API MeshStream stream(const Scene& scene,
                                const Request& request = {},
                                const WorkOptions& options = {},
                                ChunkRange chunks = {});
TETSTREAM_API MeshStream stream(const Labels& labels,
                                const Request& request = {},
                                const WorkOptions& options = {},
                                ChunkRange chunks = {});

}  // namespace tetstream
