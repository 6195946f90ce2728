// A page that draws what `tetstream mesh --report` wrote.
#pragma once

#include <string>

#include <absl/status/statusor.h>

namespace tet {

/// A page of HTML that needs nothing else, of the text of a report; `title` is its heading.
/// Parts that an older report lacks are left out. Errors: kInvalidArgument (no such report).
absl::StatusOr<std::string> report_page(const std::string& report, const std::string& title);

}  // namespace tet
