#include "server/grids/grid_service.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "core/base/printable.h"
#include "core/vdb/decode_file.h"
#include "proto/convert/grid_info_message.h"
#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "proto/convert/times.h"
#include "proto/wire/sha256.h"
#include "server/grids/read_contents.h"
#include "server/grids/upload_stream.h"
#include "server/grids/verify.h"
#include "server/ops/guard.h"
#include "server/rpc/explain.h"

namespace tet {

namespace {

constexpr int kMaxNames = 1000;
constexpr int kDefaultPage = 100;
constexpr int kMaxPage = 1000;
constexpr std::size_t kMaxQuoted = 60;

/// Memory for the trees of a file without their values, which tell what its grids are.
constexpr std::uint64_t kInfoBytes = std::uint64_t{1} << 30;

void describe(const ListedGrid& listed, v1::GridFile& file) {
  file.set_name(name_of_grid(listed.digest));
  file.set_size_bytes(static_cast<std::int64_t>(listed.size_bytes));
  *file.mutable_last_use_time() = to_proto(listed.last_use);
}

absl::Status find_missing(GridStore& store,
                          const std::string& space,
                          const v1::FindMissingGridsRequest& request,
                          v1::FindMissingGridsResponse& response) {
  if (request.names_size() > kMaxNames) {
    return over_limit("names", static_cast<std::uint64_t>(request.names_size()), kMaxNames);
  }
  for (const std::string& name : request.names()) {
    const auto digest = parse_grid_name(name);
    if (!digest.ok()) return digest.status();
    if (!store.touch({space, *digest})) response.add_missing_names(name);
  }
  return absl::OkStatus();
}

absl::Status upload_status(const GridStore& store,
                           const std::string& space,
                           const std::string& name,
                           v1::UploadStatus& response) {
  const auto digest = parse_grid_name(name);
  if (!digest.ok()) return digest.status();
  const UploadState state = store.upload_state({space, *digest});
  response.set_name(name);
  response.set_committed_size(static_cast<std::int64_t>(state.committed_size));
  response.set_complete(state.complete);
  return absl::OkStatus();
}

// A page token is the digest of the last file of the page before.
absl::Status list_page(const GridStore& store,
                       const std::string& space,
                       const v1::ListGridsRequest& request,
                       v1::ListGridsResponse& response) {
  if (request.page_size() < 0) {
    return invalid_field(absl::StrCat("page_size ", request.page_size(), " is negative"));
  }
  if (!request.page_token().empty() && !is_sha256_hex(request.page_token())) {
    return invalid_field(
        absl::StrCat("page_token \"", printable(request.page_token(), kMaxQuoted),
                     "\" was not given by this server: begin at the first page"));
  }
  const int wanted = request.page_size() == 0 ? kDefaultPage : request.page_size();
  const auto size = static_cast<std::size_t>(std::min(wanted, kMaxPage));
  const auto listed = store.list(space, request.page_token(), size + 1);
  for (std::size_t i = 0; i < std::min(size, listed.size()); ++i) {
    describe(listed[i], *response.add_files());
  }
  if (listed.size() > size) response.set_next_page_token(listed[size - 1].digest);
  return absl::OkStatus();
}

absl::StatusOr<GridLease> acquire(GridStore& store,
                                  const std::string& space,
                                  const std::string& name) {
  const auto digest = parse_grid_name(name);
  return digest.ok() ? store.acquire({space, *digest}) : digest.status();
}

/// Why a stored file cannot be read: it may not be what was stored.
absl::Status unreadable(GridStore& store, const GridLease& stored, const absl::Status& why) {
  const absl::Status intact = verify_stored(stored->path);
  if (absl::IsDataLoss(intact)) store.set_aside(stored);
  return intact.ok() ? about_file(why, stored->key.digest, stored->path.string()) : intact;
}

absl::Status fill_info(GridStore& store,
                       const absl::StatusOr<std::vector<GridInfo>>& grids,
                       const GridLease& stored,
                       v1::GridFile& response) {
  if (!grids.ok()) return unreadable(store, stored, grids.status());
  describe({stored->key.digest, stored->size_bytes, absl::Now()}, response);
  for (const GridInfo& info : *grids) to_proto(info, *response.add_grids());
  return absl::OkStatus();
}

/// Has decoders read the grids' values; the lease keeps the file from being evicted meanwhile.
void add_values(GridStore& store,
                DecoderPool& decoders,
                ContentsOrder order,
                const GridLease& stored,
                v1::GridFile& response,
                const std::shared_ptr<PendingAnswer>& pending) {
  read_contents_of(
      decoders, std::move(order), [pending] { return pending->cancelled(); },
      [pending, stored, &store,
       &response](const absl::StatusOr<std::vector<GridContents>>& contents) {
        pending->finish(guarded("GetGridInfo", [&] {
          if (!contents.ok()) return unreadable(store, stored, contents.status());
          for (std::size_t i = 0; i < contents->size(); ++i) {
            to_proto((*contents)[i], *response.mutable_grids(static_cast<int>(i)));
          }
          return absl::OkStatus();
        }));
      });
}

/// Has a decoder look at the file; the lease keeps it from being evicted meanwhile.
void grid_info(GridStore& store,
               DecoderPool& decoders,
               const v1::GetGridInfoRequest& asked,
               std::uint64_t resident_bytes,
               v1::GridFile& response,
               const std::shared_ptr<PendingAnswer>& pending) {
  const std::string& name = asked.name();
  const auto lease = acquire(store, pending->call().space(), name);
  if (!lease.ok()) return pending->finish(lease.status());
  const FileRequest request{DecodeTask::kGridList, (*lease)->path.string(), name, "",
                            kInfoBytes};
  decoders.decode(
      request, [pending] { return pending->cancelled(); },
      [request, pending, stored = *lease, &store, &decoders, &response, values = asked.values(),
       resident_bytes](const absl::StatusOr<SealedBlock>& block) {
        auto grids = grid_list_of(block, request);
        const absl::Status listed =
            guarded("GetGridInfo", [&] { return fill_info(store, grids, stored, response); });
        if (!listed.ok() || !values) return pending->finish(listed);
        add_values(store, decoders,
                   {request.path, request.file_name, *std::move(grids), resident_bytes}, stored,
                   response, pending);
      });
}

}  // namespace

grpc::ServerUnaryReactor* GridService::FindMissingGrids(
    grpc::CallbackServerContext* context,
    const v1::FindMissingGridsRequest* request,
    v1::FindMissingGridsResponse* response) {
  return answer(calls_, disk_, *context, "FindMissingGrids",
                [this, request, response](const Call& call) {
                  return find_missing(store_, call.space(), *request, *response);
                });
}

grpc::ServerReadReactor<grpc::ByteBuffer>* GridService::UploadGrid(
    grpc::CallbackServerContext* context, grpc::ByteBuffer* response) {
  return UploadStream::start({store_, calls_, disk_, stalls_}, *context, *response);
}

grpc::ServerUnaryReactor* GridService::GetUploadStatus(
    grpc::CallbackServerContext* context,
    const v1::GetUploadStatusRequest* request,
    v1::UploadStatus* response) {
  return answer(calls_, disk_, *context, "GetUploadStatus",
                [this, request, response](const Call& call) {
                  return upload_status(store_, call.space(), request->name(), *response);
                });
}

grpc::ServerUnaryReactor* GridService::ListGrids(grpc::CallbackServerContext* context,
                                                 const v1::ListGridsRequest* request,
                                                 v1::ListGridsResponse* response) {
  return answer(calls_, disk_, *context, "ListGrids",
                [this, request, response](const Call& call) {
                  store_.catch_up();
                  return list_page(store_, call.space(), *request, *response);
                });
}

grpc::ServerUnaryReactor* GridService::GetGridInfo(grpc::CallbackServerContext* context,
                                                   const v1::GetGridInfoRequest* request,
                                                   v1::GridFile* response) {
  return answer_later(calls_, disk_, *context, "GetGridInfo",
                      [this, request, response](const std::shared_ptr<PendingAnswer>& pending) {
                        grid_info(store_, decoders_, *request, resident_bytes_, *response,
                                  pending);
                      });
}

}  // namespace tet
