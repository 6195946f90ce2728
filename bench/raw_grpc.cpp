#include "bench/raw_grpc.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <grpcpp/create_channel.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "client/library/raw_call.h"
#include "core/base/check.h"
#include "proto/wire/transport.h"

namespace tet::bench {

namespace {

/// How many messages the server is to send, as the client asks for them.
struct Order {
  std::uint64_t messages = 0, message_bytes = 0;
};

grpc::ByteBuffer message_of(Order order) {
  const grpc::Slice slice(&order, sizeof order);
  return {&slice, 1};
}

/// Bytes that stay where they are.
grpc::ByteBuffer borrowed(const std::vector<char>& bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size(), grpc::Slice::STATIC_SLICE);
  return {&slice, 1};
}

/// Reads to the end, then sends what the first message asked for.
class Sink final : public grpc::ServerGenericBidiReactor {
 public:
  Sink() { StartRead(&message_); }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return begin();
    if (!has_order_) read_order();
    StartRead(&message_);
  }
  void OnWriteDone(bool ok) override {
    if (ok) return write();
    Finish(grpc::Status::CANCELLED);
  }
  void OnDone() override { delete this; }

  void read_order() {
    std::vector<grpc::Slice> slices;
    message_.Dump(&slices);
    TET_CHECK(slices.size() == 1 && slices[0].size() == sizeof order_);
    std::memcpy(&order_, slices[0].begin(), sizeof order_);
    has_order_ = true;
  }
  void begin() {
    bytes_.assign(order_.message_bytes, 'x');
    write();
  }
  void write() {
    if (order_.messages-- == 0) return Finish(grpc::Status::OK);
    message_ = borrowed(bytes_);
    StartWrite(&message_);
  }

  grpc::ByteBuffer message_;
  bool has_order_ = false;
  Order order_;
  std::vector<char> bytes_;
};

class Sinks final : public grpc::CallbackGenericService {
  grpc::ServerGenericBidiReactor* CreateReactor(grpc::GenericCallbackServerContext*) override {
    return new Sink;
  }
};

}  // namespace

struct RawGrpc::Parts {
  Sinks service;
  std::unique_ptr<grpc::Server> server;
  std::shared_ptr<grpc::Channel> channel;
};

RawGrpc::RawGrpc() : parts_(std::make_unique<Parts>()) {
  grpc::ServerBuilder builder;
  grpc::ChannelArguments arguments;
  for (const TransportSetting& setting : kTransportSettings) {
    builder.AddChannelArgument(setting.name, setting.value);
    arguments.SetInt(setting.name, setting.value);
  }
  int port = 0;
  builder.SetMaxReceiveMessageSize(-1);
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterCallbackGenericService(&parts_->service);
  parts_->server = builder.BuildAndStart();
  arguments.SetMaxReceiveMessageSize(-1);
  parts_->channel = grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port),
                                              grpc::InsecureChannelCredentials(), arguments);
}

RawGrpc::~RawGrpc() { parts_->server->Shutdown(); }

void RawGrpc::stream(std::size_t messages, std::size_t message_bytes) {
  grpc::ClientContext context;
  RawCall call(parts_->channel, context, "Raw", "Stream");
  call.write_last(message_of({messages, message_bytes}));
  for (grpc::ByteBuffer message; call.read(message);) {
  }
  call.finish();
}

void RawGrpc::upload(std::size_t messages, std::size_t message_bytes) {
  const std::vector<char> bytes(message_bytes, 'x');
  grpc::ClientContext context;
  RawCall call(parts_->channel, context, "Raw", "Upload");
  call.write(message_of({}));
  const grpc::ByteBuffer message = borrowed(bytes);
  for (std::size_t i = 0; i < messages; ++i) call.write(message);
  call.writes_done();
  call.finish();
}

}  // namespace tet::bench
