#include "core/vdb/decoder/sealed_block.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/memory_file.h"

namespace tet {
namespace {

constexpr int kSeals = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;

/// st_blocks counts in these units, whatever the file system's own block is.
constexpr std::uint64_t kStatBlock = 512;

absl::Status wrong(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the decoder's result ", what));
}

}  // namespace

absl::StatusOr<Descriptor> make_sealable_memory() {
  Descriptor memory = make_memory_file("tetstream-result");
  if (memory.is_open()) return memory;
  return absl::UnavailableError(
      absl::StrCat("there is no memory to decode into: ", std::strerror(errno)));
}

absl::Status seal_memory(int descriptor) {
  if (::fcntl(descriptor, F_ADD_SEALS, kSeals) == 0) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("cannot seal the result: ", std::strerror(errno)));
}

absl::StatusOr<SealedBlock> SealedBlock::map(int descriptor, std::uint64_t max_bytes) {
  // The system may have added seals of its own (vm.memfd_noexec).
  const int seals = ::fcntl(descriptor, F_GET_SEALS);
  if (seals < 0 || (seals & kSeals) != kSeals) return wrong("is not sealed");
  struct stat facts {};
  if (::fstat(descriptor, &facts) != 0) return wrong("has no size");
  const auto size = static_cast<std::uint64_t>(facts.st_size);
  if (size == 0 || size > max_bytes) {
    return wrong(absl::StrFormat("has %d bytes and may have 1 to %d", size, max_bytes));
  }
  // Reading a hole would fill it, at our expense.
  if (static_cast<std::uint64_t>(facts.st_blocks) * kStatBlock < size)
    return wrong("has holes");
  void* const start = ::mmap(nullptr, static_cast<std::size_t>(size), PROT_READ,
                             MAP_PRIVATE | MAP_POPULATE, descriptor, 0);
  if (start == MAP_FAILED) {
    return absl::UnavailableError(
        absl::StrCat("cannot map what was decoded: ", std::strerror(errno)));
  }
  return SealedBlock({static_cast<const std::byte*>(start), static_cast<std::size_t>(size)});
}

SealedBlock::~SealedBlock() {
  if (bytes_.empty()) return;
  // munmap takes what mmap gave; nothing is written.
  ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace tet
