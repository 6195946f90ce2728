// Reading a file by its descriptor, for processes that may not open one.
#pragma once

#include <array>
#include <cstdint>
#include <streambuf>

namespace tet {

/// A stream's buffer over the first `size` bytes of an open file; the descriptor's own position
/// stays where it is. A failing disk ends the file early. The descriptor must outlive it.
class DescriptorBuffer : public std::streambuf {
 public:
  DescriptorBuffer(int descriptor, std::int64_t size) : descriptor_(descriptor), size_(size) {}

 protected:
  int_type underflow() override;
  std::streamsize xsgetn(char* bytes, std::streamsize count) override;
  pos_type seekoff(off_type offset,
                   std::ios_base::seekdir from,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  /// Reads at `end_` and moves it; how much came, 0 at the end of the file.
  std::int64_t read(char* bytes, std::int64_t count);
  std::int64_t position() const { return end_ - (egptr() - gptr()); }

  int descriptor_;
  std::int64_t size_;
  std::int64_t end_ = 0;  ///< where in the file the buffered bytes end
  std::array<char, 1 << 15> bytes_;
};

}  // namespace tet
