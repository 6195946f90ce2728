// gRPC alone: what a stream of messages costs that nobody makes, reads or keeps.
#pragma once

#include <cstddef>
#include <memory>

namespace tet::bench {

/// A server and a client of bytes in this process, over loopback, with the settings of ours.
class RawGrpc {
 public:
  RawGrpc();
  ~RawGrpc();
  RawGrpc(const RawGrpc&) = delete;
  RawGrpc& operator=(const RawGrpc&) = delete;

  /// The server sends, from memory that is there; the client drops what it gets.
  void stream(std::size_t messages, std::size_t message_bytes);
  /// The client sends; the server drops what it gets.
  void upload(std::size_t messages, std::size_t message_bytes);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tet::bench
