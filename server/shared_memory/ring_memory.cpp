#include "server/shared_memory/ring_memory.h"

namespace tet {

absl::StatusOr<std::shared_ptr<RingMemory>> RingMemory::make(
    RingSize size, Readers readers, std::string client, std::shared_ptr<const void> charged) {
  auto memory = SealedMemory::make(static_cast<std::size_t>(size.bytes()), readers);
  if (!memory.ok()) return memory.status();
  return std::shared_ptr<RingMemory>(
      new RingMemory(*std::move(memory), size, std::move(client), std::move(charged)));
}

}  // namespace tet
