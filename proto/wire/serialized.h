// Messages to the bytes that gRPC carries, and back, where a call is in bytes.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

namespace tet {

template <class Message>
grpc::ByteBuffer serialized(const Message& message) {
  grpc::ByteBuffer bytes;
  bool own = false;
  grpc::SerializationTraits<Message>::Serialize(message, &bytes, &own);
  return bytes;
}

/// Serializes a message, and holds `held` until the last of the bytes is let go of.
template <class Message>
grpc::ByteBuffer serialized(const Message& message, std::shared_ptr<void> held) {
  struct Bytes {
    std::string text;
    std::shared_ptr<void> held;
  };
  auto bytes = std::make_unique<Bytes>(Bytes{message.SerializeAsString(), std::move(held)});
  std::string& text = bytes->text;
  const grpc::Slice slice(
      text.data(), text.size(), [](void* released) { delete static_cast<Bytes*>(released); },
      bytes.release());
  return {&slice, 1};
}

/// False when the bytes are not such a message. They are gone afterwards.
template <class Message>
bool deserialize(grpc::ByteBuffer& bytes, Message& message) {
  return grpc::SerializationTraits<Message>::Deserialize(&bytes, &message).ok();
}

}  // namespace tet
