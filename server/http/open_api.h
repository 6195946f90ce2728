// The JSON methods as an OpenAPI document, made from the protos themselves.
#pragma once

#include <string>

namespace tet {

/// Returns OpenAPI 3.1 as JSON: every route of json_routes, and every message that they reach.
std::string open_api();

}  // namespace tet
