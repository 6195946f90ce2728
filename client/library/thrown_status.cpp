#include "client/library/thrown_status.h"

#include <new>

#include "core/base/contain.h"

namespace tet {

absl::Status status_of_exception() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("there is not enough memory");
  } catch (...) {
    return absl::InternalError(words_of_exception());
  }
}

}  // namespace tet
