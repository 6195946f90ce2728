#include "server/reflection.h"

#include <memory>
#include <vector>

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/impl/server_builder_option.h>

namespace tet {

namespace {

/// Takes reflection, which gRPC gives to every server of a process, from this one.
class WithoutReflection final : public grpc::ServerBuilderOption {
  void UpdateArguments(grpc::ChannelArguments* /*arguments*/) override {}
  void UpdatePlugins(
      std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    std::erase_if(*plugins, [](const auto& plugin) {
      using Reflection = grpc::reflection::ProtoServerReflectionPlugin;
      return dynamic_cast<const Reflection*>(plugin.get()) != nullptr;
    });
  }
};

// It knows nothing of tokens.
bool serves_reflection(const Config& config) {
  return config.reflection == "on" || (config.reflection == "auto" && config.tokens.empty());
}

}  // namespace

void prepare_reflection() { grpc::reflection::InitProtoReflectionServerBuilderPlugin(); }

void choose_reflection(grpc::ServerBuilder& builder, const Config& config) {
  if (!serves_reflection(config)) builder.SetOption(std::make_unique<WithoutReflection>());
}

}  // namespace tet
