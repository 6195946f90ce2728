#include "server/grid_service.h"

#include <algorithm>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "core/grid/load.h"
#include "proto/wire/sha256.h"
#include "server/request.h"
#include "server/status.h"
#include "server/upload_stream.h"

namespace tet {

namespace {

constexpr int kMaxNames = 1000;
constexpr int kDefaultPage = 100;
constexpr int kMaxPage = 1000;

void describe(const ListedGrid& listed, v1::GridFile& file) {
  file.set_name(name_of_grid(listed.digest));
  file.set_size_bytes(static_cast<std::int64_t>(listed.size_bytes));
  const absl::Duration since_epoch = listed.last_use - absl::UnixEpoch();
  absl::Duration rest;
  file.mutable_last_use_time()->set_seconds(
      absl::IDivDuration(since_epoch, absl::Seconds(1), &rest));
  file.mutable_last_use_time()->set_nanos(static_cast<int>(absl::ToInt64Nanoseconds(rest)));
}

absl::Status find_missing(GridStore& store,
                          const v1::FindMissingGridsRequest& request,
                          v1::FindMissingGridsResponse& response) {
  if (request.names_size() > kMaxNames) {
    return over_limit("names", static_cast<std::uint64_t>(request.names_size()), kMaxNames);
  }
  for (const std::string& name : request.names()) {
    const auto digest = parse_grid_name(name);
    if (!digest.ok()) return digest.status();
    if (!store.touch(*digest)) response.add_missing_names(name);
  }
  return absl::OkStatus();
}

absl::Status upload_status(const GridStore& store,
                           const std::string& name,
                           v1::UploadStatus& response) {
  const auto digest = parse_grid_name(name);
  if (!digest.ok()) return digest.status();
  const UploadState state = store.upload_state(*digest);
  response.set_name(name);
  response.set_committed_size(static_cast<std::int64_t>(state.committed_size));
  response.set_complete(state.complete);
  return absl::OkStatus();
}

// A page token is the digest of the last file of the page before.
absl::Status list_page(const GridStore& store,
                       const v1::ListGridsRequest& request,
                       v1::ListGridsResponse& response) {
  if (request.page_size() < 0) {
    return invalid_field(absl::StrCat("page_size ", request.page_size(), " is negative"));
  }
  if (!request.page_token().empty() && !is_sha256_hex(request.page_token())) {
    return invalid_field("page_token is not one that this service gave");
  }
  const int wanted = request.page_size() == 0 ? kDefaultPage : request.page_size();
  const auto size = static_cast<std::size_t>(std::min(wanted, kMaxPage));
  const auto listed = store.list(request.page_token(), size + 1);
  for (std::size_t i = 0; i < std::min(size, listed.size()); ++i) {
    describe(listed[i], *response.add_files());
  }
  if (listed.size() > size) response.set_next_page_token(listed[size - 1].digest);
  return absl::OkStatus();
}

absl::Status grid_info(GridStore& store, const std::string& name, v1::GridFile& response) {
  const auto digest = parse_grid_name(name);
  if (!digest.ok()) return digest.status();
  const auto lease = store.acquire(*digest);
  if (!lease.ok()) return lease.status();
  const auto grids = list_grids((*lease)->path.string());
  if (!grids.ok()) return grids.status();
  describe({*digest, (*lease)->size_bytes, absl::Now()}, response);
  for (const GridInfo& info : *grids) to_proto(info, *response.add_grids());
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* GridService::FindMissingGrids(
    grpc::CallbackServerContext* context,
    const v1::FindMissingGridsRequest* request,
    v1::FindMissingGridsResponse* response) {
  return answer(calls_, disk_, *context, "FindMissingGrids", [this, request, response](Call&) {
    return find_missing(store_, *request, *response);
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
  return answer(calls_, disk_, *context, "GetUploadStatus", [this, request, response](Call&) {
    return upload_status(store_, request->name(), *response);
  });
}

grpc::ServerUnaryReactor* GridService::ListGrids(grpc::CallbackServerContext* context,
                                                 const v1::ListGridsRequest* request,
                                                 v1::ListGridsResponse* response) {
  return answer(calls_, disk_, *context, "ListGrids", [this, request, response](Call&) {
    return list_page(store_, *request, *response);
  });
}

grpc::ServerUnaryReactor* GridService::GetGridInfo(grpc::CallbackServerContext* context,
                                                   const v1::GetGridInfoRequest* request,
                                                   v1::GridFile* response) {
  return answer(calls_, disk_, *context, "GetGridInfo", [this, request, response](Call&) {
    return grid_info(store_, request->name(), *response);
  });
}

}  // namespace tet
