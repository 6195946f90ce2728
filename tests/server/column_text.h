// A column of a mesh as a value that tests compare.
#pragma once

#include <string>

#include "core/base/byte_buffer.h"

namespace tet::test {

/// Returns the column's bytes.
inline std::string text_of(const ByteBuffer& column) {
  return {reinterpret_cast<const char*>(column.bytes().data()), column.size()};
}

}  // namespace tet::test
