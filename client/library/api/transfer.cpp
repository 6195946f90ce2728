#include "tetstream/transfer.h"

#include <utility>

#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "core/base/parallel.h"
#include "core/files/transfer_files.h"

namespace tetstream {

Result<std::vector<TransferredArray>> transfer_arrays(const std::string& from,
                                                      const std::string& to,
                                                      const std::string& output,
                                                      const TransferOptions& options,
                                                      const WorkOptions& work_options) {
  return guarded([&]() -> Result<std::vector<TransferredArray>> {
    const Work work(work_options);
    tet::TaskPool pool(work_options.threads);
    const bool conserves = options.mode == TransferMode::kConservative;
    const auto report = tet::transfer_files(
        pool, {from, to, output},
        {.mode = conserves ? tet::TransferMode::kConservative : tet::TransferMode::kLinear,
         .clamp = options.clamp,
         .arrays = options.arrays},
        work.cancellation());
    if (!report.ok()) return to_public(report.status());
    std::vector<TransferredArray> arrays;
    for (const tet::TransferredArray& array : report->arrays) {
      arrays.push_back({array.name, array.at_points, array.old_integral, array.new_integral});
    }
    return arrays;
  });
}

}  // namespace tetstream
