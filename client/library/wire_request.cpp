#include "client/library/wire_request.h"

#include "proto/convert/request.h"

namespace tet {

v1::MeshRequest wire_request(const MeshRequest& request,
                             const std::string& name,
                             const std::vector<std::string>& grids) {
  v1::MeshRequest message;
  message.set_name(name);
  if (grids.size() == 1) message.set_grid_name(grids.front());
  if (grids.size() > 1) message.mutable_grid_names()->Assign(grids.begin(), grids.end());
  to_proto(request, message);
  return message;
}

}  // namespace tet
