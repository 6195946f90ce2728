#include "core/image/outline_image.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/image/binary_header.h"
#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/meta_header.h"
#include "core/image/nifti_header.h"
#include "core/image/nrrd_header.h"
#include "core/image/numpy_header.h"
#include "core/image/text_header.h"
#include "core/image/vti_header.h"

namespace tet {
namespace {

/// As much of a file as tells what it is.
constexpr std::size_t kMagicBytes = 4096;
constexpr std::size_t kXmlHeaderBytes = std::size_t{1} << 20;

bool is_gzip(std::span<const std::byte> head) {
  return head.size() > 2 && head[0] == std::byte{0x1f} && head[1] == std::byte{0x8b};
}

std::span<const std::byte> head_of(const ByteSource& source,
                                   std::size_t bytes,
                                   std::vector<std::byte>& buffer) {
  const std::span<const std::byte> head = source.window(0, bytes, buffer);
  return head.first(std::min(head.size(), bytes));
}

/// The last four bytes of a gzip file say how long it was, modulo 2^32; of several members, how
/// long the last one was.
ImageOutline outline_packed(const ByteSource& source) {
  constexpr std::uint64_t kLeast = 18;
  if (source.size() < kLeast) refuse_image("it is truncated: it ends within its gzip header");
  std::vector<std::byte> buffer;
  const std::span<const std::byte> tail = source.window(source.size() - 4, 4, buffer);
  ImageOutline outline;
  outline.format = ImageFormat::kNifti;
  outline.packed = true;
  outline.unpacked_bytes = BinaryHeader(tail, false).at<std::uint32_t>(0);
  if (outline.unpacked_bytes / kMostExpansion > source.size()) {
    refuse_image("its last bytes claim more than gzip can have packed into it");
  }
  return outline;
}

ImageOutline outline_of(const ByteSource& source) {
  std::vector<std::byte> buffer;
  const std::span<const std::byte> head = head_of(source, kMagicBytes, buffer);
  if (is_gzip(head)) return outline_packed(source);
  if (is_vti(head)) {
    std::vector<std::byte> more;
    return read_vti_header(head_of(source, kXmlHeaderBytes, more), source.size());
  }
  std::vector<std::byte> more;
  const std::span<const std::byte> text = head_of(source, kTextHeaderBytes + 16, more);
  if (is_nrrd(head)) return read_nrrd_header(text, source.size());
  if (is_meta(head)) return read_meta_header(text, source.size());
  if (is_numpy(head)) return read_numpy_header(text, source.size());
  if (is_nifti(head)) return read_nifti_header(head, source.size());
  refuse_image("it is no image: NIfTI, NRRD, MetaImage, VTK image data or an array of NumPy");
}

}  // namespace

bool is_image(const ByteSource& source) {
  std::vector<std::byte> buffer;
  const std::span<const std::byte> head = head_of(source, kMagicBytes, buffer);
  return is_gzip(head) || is_nrrd(head) || is_meta(head) || is_numpy(head) || is_vti(head) ||
         is_nifti(head);
}

absl::StatusOr<ImageOutline> outline_image(const ByteSource& source) {
  try {
    return outline_of(source);
  } catch (const ImageRefusal& refusal) {
    return refusal.status();
  }
}

}  // namespace tet
