#include "core/image/image_values.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <string_view>
#include <type_traits>

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/image/binary_header.h"
#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/inflate.h"
#include "core/image/nifti_header.h"
#include "core/image/outline_image.h"
#include "core/image/text_header.h"
#include "core/image/vti_header.h"

namespace tet {
namespace {

constexpr std::size_t kWindow = std::size_t{256} << 10;

[[noreturn]] void refuse_short(const ImageArray& array) {
  refuse_image(
      absl::StrFormat("it is truncated: it has fewer than the %d values that its header "
                      "tells of",
                      array.voxels()));
}

/// Reads bytes of a file one after the other.
class FileBytes {
 public:
  FileBytes(const ByteSource& source, std::uint64_t at, std::uint64_t bytes)
      : source_(source), at_(at), end_(at + bytes) {}

  /// At most `into` bytes; none at the end.
  std::size_t read(std::span<std::byte> into) {
    std::size_t filled = 0;
    while (filled < into.size()) {
      if (used_ == window_.size() && !refill()) break;
      const std::size_t count = std::min(into.size() - filled, window_.size() - used_);
      std::memcpy(into.data() + filled, window_.data() + used_, count);
      used_ += count;
      filled += count;
    }
    return filled;
  }

 private:
  bool refill() {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(kWindow, end_ - at_));
    if (wanted == 0) return false;
    window_ = source_.window(at_, wanted, buffer_);
    window_ = window_.first(std::min(window_.size(), wanted));
    used_ = 0;
    at_ += window_.size();
    return !window_.empty();
  }

  ByteSource source_;
  std::uint64_t at_, end_;
  std::vector<std::byte> buffer_;
  std::span<const std::byte> window_;
  std::size_t used_ = 0;
};

/// Base64, four characters at a time: VTK pads where a part of its data ends, and goes on.
class Base64Bytes {
 public:
  explicit Base64Bytes(FileBytes& text) : text_(text) {}

  std::size_t read(std::span<std::byte> into) {
    std::size_t filled = 0;
    while (filled < into.size()) {
      if (used_ == count_ && !refill()) break;
      into[filled++] = bytes_[used_++];
    }
    return filled;
  }

 private:
  /// Six bits; 64 for padding; nothing at the end.
  int next() {
    std::byte c{};
    while (text_.read({&c, 1}) == 1) {
      const auto letter = std::to_integer<unsigned char>(c);
      if (absl::ascii_isspace(letter)) continue;
      if (letter >= 'A' && letter <= 'Z') return letter - 'A';
      if (letter >= 'a' && letter <= 'z') return letter - 'a' + 26;
      if (letter >= '0' && letter <= '9') return letter - '0' + 52;
      if (letter == '+') return 62;
      if (letter == '/') return 63;
      if (letter == '=') return 64;
      return -1;
    }
    return -1;
  }
  bool refill() {
    std::array<int, 4> six{};
    for (int& part : six) {
      part = next();
      if (part < 0) return false;
    }
    if (six[0] == 64 || six[1] == 64) return false;
    const unsigned bits =
        static_cast<unsigned>(six[0]) << 18 | static_cast<unsigned>(six[1]) << 12 |
        static_cast<unsigned>(six[2] & 63) << 6 | static_cast<unsigned>(six[3] & 63);
    bytes_ = {static_cast<std::byte>(bits >> 16), static_cast<std::byte>(bits >> 8 & 255),
              static_cast<std::byte>(bits & 255)};
    count_ = six[2] == 64 ? 1 : six[3] == 64 ? 2 : 3;
    used_ = 0;
    return true;
  }

  FileBytes& text_;
  std::array<std::byte, 3> bytes_{};
  std::size_t used_ = 0, count_ = 0;
};

/// Fills a span, or throws.
using ReadAll = std::function<void(std::span<std::byte>)>;

template <class Bytes>
ReadAll reader_of(Bytes& bytes, const ImageArray& array) {
  return [&bytes, &array](std::span<std::byte> into) {
    if (bytes.read(into) != into.size()) refuse_short(array);
  };
}

std::uint64_t read_length(const ReadAll& read, const ImageArray& array) {
  std::array<std::byte, 8> raw{};
  read(std::span<std::byte>(raw).first(array.length_bytes));
  const BinaryHeader header(std::span<const std::byte>(raw).first(array.length_bytes),
                            array.big_endian);
  return array.length_bytes == 8 ? header.at<std::uint64_t>(0) : header.at<std::uint32_t>(0);
}

/// VTK's blocks: how many, how long one is, how long the last one, and how long each is packed.
void read_deflated_blocks(const ReadAll& read,
                          const ImageArray& array,
                          std::span<std::byte> values) {
  const std::uint64_t count = read_length(read, array), block = read_length(read, array),
                      last = read_length(read, array);
  const std::uint64_t whole = count - (last > 0 ? 1 : 0);
  const bool fits = block > 0 && count > 0 && last < block && whole <= values.size() / block &&
                    whole * block + last == values.size();
  if (!fits) {
    refuse_image(
        absl::StrFormat("its %d packed blocks of %d bytes are not the %d bytes of its "
                        "values",
                        count, block, values.size()));
  }
  std::vector<std::uint64_t> packed(count);
  for (std::uint64_t& bytes : packed) bytes = read_length(read, array);
  std::vector<std::byte> buffer;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t bytes = i < whole ? block : last;
    if (packed[i] > bytes + bytes / 100 + 1024) {
      refuse_image("one of its packed blocks is longer than what it holds");
    }
    buffer.resize(packed[i]);
    read(buffer);
    inflate_block(buffer, values.subspan(i * block, bytes));
  }
}

void read_blocks(const ReadAll& read, const ImageArray& array, std::span<std::byte> values) {
  if (array.blocks_deflated) return read_deflated_blocks(read, array, values);
  const std::uint64_t bytes = read_length(read, array);
  if (bytes != values.size()) {
    refuse_image(
        absl::StrFormat("its values take %d bytes, and %d are stored", values.size(), bytes));
  }
  read(values);
}

/// Words of a text, one after the other.
class Words {
 public:
  explicit Words(FileBytes& text) : text_(text) {}

  /// Empty at the end; good until the next call.
  std::string_view next() {
    constexpr std::size_t kLongest = 512;
    word_.clear();
    std::byte c{};
    while (text_.read({&c, 1}) == 1) {
      const auto letter = std::to_integer<unsigned char>(c);
      const bool between = absl::ascii_isspace(letter) || letter == ',';
      if (between && !word_.empty()) return word_;
      if (between) continue;
      if (letter == '<') break;
      if (word_.size() == kLongest) refuse_image("its text has a word of over 512 letters");
      word_ += static_cast<char>(letter);
    }
    return word_;
  }

 private:
  FileBytes& text_;
  std::string word_;
};

template <class T>
T parsed(std::string_view word) {
  if constexpr (std::is_floating_point_v<T>) {
    double value = 0;
    if (absl::SimpleAtod(as_absl(word), &value)) return static_cast<T>(value);
  } else if constexpr (std::is_unsigned_v<T>) {
    std::uint64_t value = 0;
    if (absl::SimpleAtoi(as_absl(word), &value) && value <= std::numeric_limits<T>::max()) {
      return static_cast<T>(value);
    }
  } else {
    std::int64_t value = 0;
    if (absl::SimpleAtoi(as_absl(word), &value) && value <= std::numeric_limits<T>::max() &&
        value >= std::numeric_limits<T>::min()) {
      return static_cast<T>(value);
    }
  }
  refuse_image(absl::StrCat("its text has ", quoted_text(word), ", which is no such number"));
}

void read_text(FileBytes& text, const ImageArray& array, std::span<std::byte> values) {
  Words words(text);
  visit_values(array.type, values, [&](auto typed) {
    using T = std::remove_const_t<typename decltype(typed)::element_type>;
    for (std::size_t i = 0; i < typed.size(); ++i) {
      const std::string_view word = words.next();
      if (word.empty()) refuse_short(array);
      const T value = parsed<T>(word);
      std::memcpy(values.data() + i * sizeof(T), &value, sizeof(T));
    }
  });
  if (!words.next().empty()) {
    refuse_image(absl::StrFormat("it has more than the %d values that its header tells of",
                                 array.voxels()));
  }
}

/// Exchanges the bytes of each number.
void swap_bytes(std::uint32_t width, std::span<std::byte> values) {
  for (std::size_t at = 0; at < values.size(); at += width) {
    std::reverse(values.begin() + static_cast<std::ptrdiff_t>(at),
                 values.begin() + static_cast<std::ptrdiff_t>(at + width));
  }
}

/// The sum of a stream comes at its end, and is looked at by whoever reads that far.
void check_sum(Inflater& inflater) {
  std::byte beyond{};
  if (inflater.read({&beyond, 1}) == 0) return;
  refuse_image("it unpacks to more than the values that its header tells of");
}

void read_packed(const ByteSource& source,
                 const ImageArray& array,
                 std::span<std::byte> values) {
  Inflater bytes(source, 0, source.size());
  std::vector<std::byte> skipped(kWindow);
  for (std::uint64_t left = array.offset; left > 0;) {
    const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(left, kWindow));
    if (bytes.read(std::span(skipped).first(piece)) != piece) refuse_short(array);
    left -= piece;
  }
  if (bytes.read(values) != values.size()) refuse_short(array);
  check_sum(bytes);
}

void read_stored(const ByteSource& source,
                 const ImageArray& array,
                 std::span<std::byte> values) {
  FileBytes bytes(source, array.offset, array.bytes);
  switch (array.encoding) {
    case ImageEncoding::kRaw:
      return reader_of(bytes, array)(values);
    case ImageEncoding::kDeflate: {
      Inflater inflater(source, array.offset, array.bytes);
      reader_of(inflater, array)(values);
      return check_sum(inflater);
    }
    case ImageEncoding::kText:
      return read_text(bytes, array, values);
    case ImageEncoding::kVtiBase64: {
      Base64Bytes decoded(bytes);
      return read_blocks(reader_of(decoded, array), array, values);
    }
    case ImageEncoding::kVtiRaw:
      return read_blocks(reader_of(bytes, array), array, values);
  }
}

/// A length as gzip stores it.
std::uint64_t modulo_gzip(std::uint64_t bytes) { return bytes & 0xFFFFFFFF; }

/// How much a file of gzip holds, of which `bytes` has unpacked `unpacked` so far. Unpacks the
/// rest of it, and refuses what does not end as gzip does.
std::uint64_t measure(Inflater& bytes, std::uint64_t unpacked, const ImageOutline& packed) {
  std::vector<std::byte> passed(kWindow);
  std::size_t count = 0;
  do {
    count = bytes.read(passed);
    unpacked += count;
  } while (count == passed.size());
  if (modulo_gzip(bytes.member_bytes()) == packed.unpacked_bytes) return unpacked;
  refuse_image("it is truncated, or foreign bytes follow it: it does not end as gzip does");
}

/// The length that a file of gzip claims is not the whole one where it is of 4 GiB and more, or
/// has several members: whatever its header tells must have that length modulo 2^32, or else
/// all is unpacked so as to know.
ImageOutline outline_unpacked(const ByteSource& source, const ImageOutline& packed) {
  Inflater bytes(source, 0, source.size());
  std::vector<std::byte> head(kNiftiHeaderBytes);
  head.resize(bytes.read(head));
  if (!is_nifti(head)) {
    refuse_contents("it is packed by gzip, and only NIfTI images may be: unpack it");
  }
  ImageOutline outline = read_nifti_header(head, kMostExpansion * source.size());
  const ImageArray& array = outline.arrays.front();
  if (modulo_gzip(array.offset + array.value_bytes()) != packed.unpacked_bytes) {
    outline = read_nifti_header(head, measure(bytes, head.size(), packed));
  }
  outline.packed = true;
  outline.unpacked_bytes = packed.unpacked_bytes;
  return outline;
}

void check_reading(std::uint64_t bytes, std::uint64_t most) {
  if (bytes <= most) return;
  throw ImageRefusal(absl::ResourceExhaustedError(absl::StrFormat(
      "as its header tells when it is unpacked, reading it takes %d bytes of memory, and %d is "
      "the most that a packed file of its length gets: unpack it, use larger voxels, or raise "
      "the limit",
      bytes, most)));
}

}  // namespace

ImageOutline full_outline(const ByteSource& source, std::uint64_t most_reading_bytes) {
  absl::StatusOr<ImageOutline> outline = outline_image(source);
  if (!outline.ok()) throw ImageRefusal(outline.status());
  if (outline->packed) {
    ImageOutline unpacked = outline_unpacked(source, *outline);
    check_reading(unpacked.reading_bytes(source.size()), most_reading_bytes);
    return unpacked;
  }
  if (!outline->cut) return *std::move(outline);
  std::vector<std::byte> text;
  return read_vti_header(source.window(0, static_cast<std::size_t>(source.size()), text),
                         source.size());
}

std::vector<std::byte> read_values(const ByteSource& source,
                                   const ImageOutline& outline,
                                   const ImageArray& array) {
  std::vector<std::byte> values(array.value_bytes());
  if (outline.packed) {
    read_packed(source, array, values);
  } else {
    read_stored(source, array, values);
  }
  constexpr bool kBig = std::endian::native == std::endian::big;
  const std::uint32_t width = bytes_of(array.type);
  if (array.encoding != ImageEncoding::kText && array.big_endian != kBig && width > 1) {
    swap_bytes(width, values);
  }
  return values;
}

}  // namespace tet
