// The files of many jobs: each goes up once, whoever of them comes first.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_input.h"

namespace tet {

/// Thread safety: any thread may call any member.
class GridUploads {
 public:
  explicit GridUploads(MeshClient& client) : client_(client) {}

  /// The name of the stored file; uploads it, or waits for whoever does. Errors: those of
  /// upload_input, which the next one to ask tries again.
  absl::StatusOr<std::string> name_of(const MeshInput& input,
                                      const UploadWatch& watch,
                                      const Cancellation& cancellation);

  /// The server has lost the file: the next one to ask uploads it again.
  void forget(const MeshInput& input);

 private:
  struct Upload {
    std::mutex mutex;
    std::string name;  ///< once it is stored
  };
  Upload& upload_of(const MeshInput& input);

  MeshClient& client_;
  std::mutex mutex_;
  std::map<std::pair<std::string, SurfaceChoices>, std::unique_ptr<Upload>> uploads_;
};

}  // namespace tet
