// Exceptions that nobody foresaw must not end a process that many others use.
#pragma once

#include <string>

namespace tet {

/// Told what was thrown, and by what kind of work. May be called by any thread.
using ExceptionTeller = void (*)(const char* where, const std::string& what);

/// From now on `teller` is told of every exception that `contain` stops; before that a line on
/// stderr tells of it.
void tell_exceptions(ExceptionTeller teller) noexcept;

/// For a catch block: the exception's own words, or that it has none.
std::string words_of_exception();

/// For a catch block: tells of the exception.
void tell_exception(const char* where) noexcept;

/// Runs `body`. What it throws is told of, and ends here: for the outermost function of a
/// thread or a task, out of which an exception would end the process.
template <class Body>
void contain(const char* where, const Body& body) noexcept {
  try {
    body();
  } catch (...) {
    tell_exception(where);
  }
}

}  // namespace tet
