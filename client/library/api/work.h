// One call's work: how it is stopped, and what becomes of what it throws.
#pragma once

#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <stop_token>
#include <type_traits>

#include "core/base/cancel.h"
#include "tetstream/request.h"
#include "tetstream/status.h"

namespace tetstream {

/// A caller's stop token and deadline as the mesher knows them.
class Work {
 public:
  explicit Work(const WorkOptions& options)
      : cancellation_(options.deadline ? tet::Cancellation(*options.deadline)
                                       : tet::Cancellation()),
        stopped_(options.stop, [this] { cancellation_.cancel(); }) {}
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  const tet::Cancellation& cancellation() const noexcept { return cancellation_; }

 private:
  tet::Cancellation cancellation_;
  std::stop_callback<std::function<void()>> stopped_;
};

/// Calls `work`; nothing that is thrown beneath reaches the caller of this library.
template <class Function>
std::invoke_result_t<Function> guarded(const Function& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::kResourceExhausted, "there is not enough memory");
  } catch (const std::exception& error) {
    return Status(StatusCode::kInternal, error.what());
  }
}

}  // namespace tetstream
