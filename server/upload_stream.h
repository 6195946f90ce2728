// One UploadGrid call.
#pragma once

#include <memory>
#include <string>

#include <grpcpp/support/server_callback.h>

#include "core/base/parallel.h"
#include "server/calls.h"
#include "server/grid_store.h"
#include "server/grid_upload.h"
#include "tetstream/v1/grids.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// The reactor of one upload: each message is written to disk as a task, and the next one is
/// read when that is done. So nothing here runs twice at once, and no lock is needed.
///
/// Owned by the call: deletes itself when gRPC is done with it.
class UploadStream final : public grpc::ServerReadReactor<v1::UploadGridRequest> {
 public:
  UploadStream(GridStore& store,
               CallRegistry& calls,
               TaskPool& disk,
               const grpc::CallbackServerContext& context,
               v1::UploadGridResponse& response);

 private:
  void OnReadDone(bool ok) override;
  void OnDone() override { delete this; }

  void take_message();
  absl::Status take_start(const v1::UploadStart& start);
  absl::Status take_data(const v1::UploadData& data);
  void finish(const absl::Status& status);

  GridStore& store_;
  TaskPool& disk_;
  Call call_;
  v1::UploadGridResponse& response_;
  v1::UploadGridRequest message_;
  std::unique_ptr<GridUpload> upload_;
};

}  // namespace tet
