#include "core/base/posix/sealed_memory.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/posix/memory_file.h"

namespace tet {

namespace {

constexpr int kSizeSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

/// A descriptor of the same memory that only reads; none is open where there is none to be had.
/// Whoever has it cannot have another: to open the file takes its owner.
Descriptor for_reading(const Descriptor& memory) noexcept {
  if (::fchmod(memory.number(), S_IRUSR) != 0) return {};
  return Descriptor(
      ::open(absl::StrCat("/proc/self/fd/", memory.number()).c_str(), O_RDONLY | O_CLOEXEC));
}

absl::Status no_memory(std::size_t bytes) {
  return absl::ResourceExhaustedError(
      absl::StrCat("no shared memory of ", bytes, " bytes: ", std::strerror(errno)));
}

}  // namespace

Mapping::~Mapping() {
  if (begin_ != nullptr) ::munmap(begin_, size_);
}

Mapping::Mapping(Mapping&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)), size_(std::exchange(other.size_, 0)) {}

Mapping& Mapping::operator=(Mapping&& other) noexcept {
  std::swap(begin_, other.begin_);
  std::swap(size_, other.size_);
  return *this;
}

absl::StatusOr<SealedMemory> SealedMemory::make(std::size_t bytes, Readers readers) {
  SealedMemory memory;
  memory.writing_ = make_memory_file("tetstream-chunks");
  const int number = memory.writing_.number();
  if (!memory.writing_.is_open() || ::ftruncate(number, static_cast<off_t>(bytes)) != 0) {
    return no_memory(bytes);
  }
  void* const begin = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, number, 0);
  if (begin == MAP_FAILED) return no_memory(bytes);
  memory.mapping_ = Mapping(begin, bytes);
  if (readers == Readers::kOtherUser) memory.reading_ = for_reading(memory.writing_);
  const int seals = memory.can_be_given_up() ? kSizeSeals : kSizeSeals | F_SEAL_FUTURE_WRITE;
  if (::fcntl(number, F_ADD_SEALS, seals) != 0) {
    return absl::UnimplementedError(
        absl::StrCat("the kernel does not seal shared memory: ", std::strerror(errno)));
  }
  return memory;
}

void SealedMemory::give_up() const noexcept {
  if (!can_be_given_up()) return;
  ::fallocate(writing_.number(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
              static_cast<off_t>(mapping_.size()));
}

absl::StatusOr<SharedMemory> SharedMemory::map(const Descriptor& descriptor,
                                               std::size_t bytes) {
  struct stat size {};
  const int seals = ::fcntl(descriptor.number(), F_GET_SEALS);
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0) {
    return absl::InvalidArgumentError("shared memory that may become shorter");
  }
  if (::fstat(descriptor.number(), &size) != 0 || size.st_size < 0 ||
      static_cast<std::size_t>(size.st_size) < bytes || bytes == 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("shared memory of ", size.st_size, " bytes in place of ", bytes));
  }
  void* const begin = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor.number(), 0);
  if (begin == MAP_FAILED) return no_memory(bytes);
  SharedMemory memory;
  memory.mapping_ = Mapping(begin, bytes);
  memory.device_ = size.st_dev;
  memory.number_ = size.st_ino;
  memory.holds_pages_ = (seals & (F_SEAL_WRITE | F_SEAL_FUTURE_WRITE)) != 0;
  return memory;
}

// Nothing else gets its number while it is mapped.
bool SharedMemory::is_of(const Descriptor& descriptor, std::size_t bytes) const noexcept {
  struct stat told {};
  return mapping_.size() == bytes && ::fstat(descriptor.number(), &told) == 0 &&
         told.st_dev == device_ && told.st_ino == number_;
}

}  // namespace tet
