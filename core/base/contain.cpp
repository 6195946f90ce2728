#include "core/base/contain.h"

#include <atomic>
#include <cstdio>
#include <exception>

namespace tet {
namespace {

std::atomic<ExceptionTeller> the_teller{nullptr};

}  // namespace

void tell_exceptions(ExceptionTeller teller) noexcept { the_teller = teller; }

std::string words_of_exception() {
  try {
    throw;
  } catch (const std::exception& exception) {
    return exception.what();
  } catch (...) {
    return "an exception of no known type";
  }
}

void tell_exception(const char* where) noexcept {
  try {
    const std::string what = words_of_exception();
    if (const ExceptionTeller teller = the_teller) return teller(where, what);
    std::fprintf(stderr, "tetstream: %s failed: %s\n", where, what.c_str());
  } catch (...) {  // there is no memory to tell of it
    std::fputs("tetstream: an exception was dropped\n", stderr);
  }
}

}  // namespace tet
