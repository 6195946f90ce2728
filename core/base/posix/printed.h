// What programs print where it may be their answer.
#pragma once

namespace tet {

/// What a program exits with that would with `code`: 1 where that is 0 and some of what it has
/// printed did not arrive, as on a full disk, which is then told on stderr in its name; and
/// where nobody reads it any more, without a word, what a shell says of a program that ends by
/// SIGPIPE. Nothing is printed afterwards.
int exit_code_of_printed(int code, const char* program);

}  // namespace tet
