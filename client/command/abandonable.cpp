#include "client/command/abandonable.h"

#include <atomic>

namespace tet {
namespace {

std::atomic<bool> work_was_abandoned{false};

}  // namespace

void note_abandoned_work() noexcept { work_was_abandoned = true; }

bool has_abandoned_work() noexcept { return work_was_abandoned; }

}  // namespace tet
