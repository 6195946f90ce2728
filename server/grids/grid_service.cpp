#include "server/grids/grid_service.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "core/base/printable.h"
#include "core/vdb/decoder/decode_file.h"
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

/// What looking into a stored file needs. The lease keeps it from being evicted meanwhile.
struct Inquiry {
  GridStore& store;
  FairTasks& disk;
  DecoderPool& decoders;
  std::uint64_t resident_bytes = 0;
  bool values = false;
  GridLease stored;
  v1::GridFile& response;
  std::shared_ptr<PendingAnswer> pending;
};
using SharedInquiry = std::shared_ptr<const Inquiry>;

/// Whether it says nothing of the file.
bool is_of_the_moment(const absl::Status& why) {
  return absl::IsCancelled(why) || absl::IsUnavailable(why);
}

/// Ends a call about a stored file that cannot be read: it may not be what was stored, which
/// takes as long to find out as the file is large. Threads of decoders are not for that.
void tell_unreadable(const SharedInquiry& about, const absl::Status& why) {
  const std::string path = about->stored->path.string();
  const absl::Status told = about_file(why, about->stored->key.digest, path);
  if (is_of_the_moment(why)) return about->pending->finish(told);
  verify_in_turns({about->disk, about->pending->call().client(),
                   [pending = about->pending] { return pending->cancelled(); }},
                  path, [about, told](const absl::Status& intact) {
                    if (absl::IsDataLoss(intact)) about->store.set_aside(about->stored);
                    about->pending->finish(intact.ok() ? told : intact);
                  });
}

/// Has decoders read the grids' values.
void add_values(const SharedInquiry& about, ContentsOrder order) {
  read_contents_of(
      about->decoders, std::move(order), [about] { return about->pending->cancelled(); },
      [about](const absl::StatusOr<std::vector<GridContents>>& contents) {
        about->pending->finish_unless_ok(guarded("GetGridInfo", [&] {
          if (!contents.ok()) return tell_unreadable(about, contents.status());
          for (std::size_t i = 0; i < contents->size(); ++i) {
            to_proto((*contents)[i], *about->response.mutable_grids(static_cast<int>(i)));
          }
          about->pending->finish(absl::OkStatus());
        }));
      });
}

/// Takes what a decoder has listed.
void take_list(const SharedInquiry& about,
               const FileRequest& request,
               absl::StatusOr<std::vector<GridInfo>> grids) {
  if (!grids.ok()) return tell_unreadable(about, grids.status());
  const StoredGrid& stored = *about->stored;
  describe({stored.key.digest, stored.size_bytes, absl::Now()}, about->response);
  for (const GridInfo& info : *grids) to_proto(info, *about->response.add_grids());
  if (!about->values) return about->pending->finish(absl::OkStatus());
  add_values(about, {about->pending->call().client(), request.path, request.file_name,
                     *std::move(grids), about->resident_bytes});
}

/// Has a decoder look at the file.
void grid_info(const SharedInquiry& about) {
  const FileRequest request{DecodeTask::kGridList, about->stored->path.string(),
                            name_of_grid(about->stored->key.digest), "", kInfoBytes};
  about->decoders.decode(
      about->pending->call().client(), request, [about] { return about->pending->cancelled(); },
      [about, request](const absl::StatusOr<SealedBlock>& block) {
        about->pending->finish_unless_ok(guarded(
            "GetGridInfo", [&] { take_list(about, request, grid_list_of(block, request)); }));
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
                        auto lease = acquire(store_, pending->call().space(), request->name());
                        if (!lease.ok()) return pending->finish(lease.status());
                        grid_info(std::make_shared<const Inquiry>(
                            Inquiry{store_, disk_, decoders_, resident_bytes_,
                                    request->values(), *std::move(lease), *response, pending}));
                      });
}

}  // namespace tet
