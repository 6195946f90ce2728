#include "server/meshing/load_grid.h"

#include <memory>
#include <string>
#include <utility>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/vdb/decoder/decode_file.h"
#include "proto/wire/sha256.h"
#include "server/grids/verify.h"
#include "server/ops/guard.h"

namespace tet {

namespace {

DecodeTask task_of(const VolumeKey& key) {
  if (key.labels) return DecodeTask::kLabels;
  return key.component ? DecodeTask::kField : DecodeTask::kVolume;
}

/// What a decoder made, checked.
absl::StatusOr<GridInMemory> grid_made_of(const absl::StatusOr<SealedBlock>& block,
                                          const FileRequest& request,
                                          const VolumeCache::Cancelled& abandoned) {
  const Cancellation cancellation(Cancellation::Clock::time_point::max(), abandoned);
  if (request.task == DecodeTask::kLabels) {
    absl::StatusOr<LabelVolume> labels = labels_of(block, request, cancellation);
    if (!labels.ok()) return labels.status();
    return std::make_shared<const LabelVolume>(*std::move(labels));
  }
  absl::StatusOr<Volume> volume = volume_of(block, request, cancellation);
  if (!volume.ok()) return volume.status();
  return std::make_shared<const Volume>(*std::move(volume));
}

/// A stored grid on its way to the cache: who waits for it, and what is told when it is there.
struct Loading {
  std::string client;
  FileRequest request;
  VolumeCache::Cancelled abandoned;
  VolumeCache::LoadDone done;
};

/// Makes a grid of what a decoder handed back, on a thread for that.
void finish(LargePlans& loads,
            const std::shared_ptr<const Loading>& loading,
            absl::StatusOr<SealedBlock> decoded) {
  auto block = std::make_shared<absl::StatusOr<SealedBlock>>(std::move(decoded));
  loads.post(loading->client, [loading, block] {
    loading->done(guarded("reading a grid", [&] {
      return grid_made_of(*block, loading->request, loading->abandoned);
    }));
  });
}

/// Checks the file of a grid, and has a decoder read it.
void begin(LargePlans& loads,
           DecoderPool& decoders,
           const std::shared_ptr<const Loading>& loading) {
  const absl::Status intact = guarded("reading a grid", [&] {
    return verify_stored(loading->request.path, loading->abandoned);
  });
  if (!intact.ok()) return loading->done(intact);
  decoders.decode(loading->client, loading->request, loading->abandoned,
                  [&loads, loading](absl::StatusOr<SealedBlock> decoded) {
                    finish(loads, loading, std::move(decoded));
                  });
}

}  // namespace

VolumeCache::Loader grid_loader(LargePlans& loads,
                                DecoderPool& decoders,
                                std::uint64_t max_bytes) {
  return [&loads, &decoders, max_bytes](const VolumeCache::Load& load,
                                        VolumeCache::Cancelled abandoned,
                                        VolumeCache::LoadDone done) {
    const VolumeKey& key = load.key;
    FileRequest request{task_of(key),  load.path, name_of_grid(key.digest),
                        key.grid_name, max_bytes, key.component.value_or(0)};
    const auto loading = std::make_shared<const Loading>(
        Loading{load.client, std::move(request), std::move(abandoned), std::move(done)});
    loads.post(loading->client,
               [&loads, &decoders, loading] { begin(loads, decoders, loading); });
  };
}

}  // namespace tet
