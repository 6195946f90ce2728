// The protobuf bytes before a piece of an upload, so that it is sent from where it was read.
#pragma once

#include <cstddef>
#include <cstdint>

#include "proto/wire/field_writer.h"

namespace tet {

/// Numbers of UploadGridRequest's and UploadData's fields.
namespace upload_field {
inline constexpr std::uint32_t kData = 2;  ///< UploadGridRequest.data
inline constexpr std::uint32_t kOffset = 1;
inline constexpr std::uint32_t kBytes = 2;
}  // namespace upload_field

/// What stands before the `size` bytes of a file from `offset` on in an UploadGridRequest.
inline FieldWriter upload_prefix(std::uint64_t offset, std::uint64_t size) noexcept {
  FieldWriter data;
  data.number(upload_field::kOffset, offset);
  data.bytes(upload_field::kBytes, size);
  FieldWriter request;
  request.message(upload_field::kData, data.size() + size);
  request.append(data);
  return request;
}

}  // namespace tet
