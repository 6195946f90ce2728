#include "tests/fuzz/fuzzed_services.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>
#include <google/protobuf/duration.pb.h>
#include <google/protobuf/timestamp.pb.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/support/sync_stream.h>

#include "core/base/contain.h"
#include "grpc/health/v1/health.pb.h"
#include "proto/convert/times.h"
#include "proto/wire/sha256.h"
#include "server/ops/logging.h"
#include "tests/fuzz/fuzz_target.h"
#include "tetstream/v1/grids.pb.h"
#include "tetstream/v1/jobs.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::services_fuzz {
namespace {

namespace v1 = ::tetstream::v1;

/// How long one waits for what has to come, and how long the server does for that.
constexpr std::chrono::seconds kGenerous{600};
constexpr int kEdge = 12;

// A fuzzer's inputs are soon given up; first inputs are answered, however slow the machine is.
#ifdef TET_LIBFUZZER
constexpr std::uint64_t kPatienceSeconds = 1;
#else
constexpr std::uint64_t kPatienceSeconds = kGenerous.count();
#endif

/// A method that is added is driven, or this fails.
void check_methods() {
  std::size_t methods = 0;
  for (const auto* file : {v1::GridFile::descriptor()->file(), v1::Job::descriptor()->file(),
                           v1::MeshRequest::descriptor()->file(),
                           grpc::health::v1::HealthCheckRequest::descriptor()->file()}) {
    for (int s = 0; s < file->service_count(); ++s) {
      for (int m = 0; m < file->service(s)->method_count(); ++m, ++methods) {
        const std::string& name = file->service(s)->method(m)->full_name();
        if (std::find(kMethods.begin(), kMethods.end(), name) != kMethods.end()) continue;
        std::fprintf(stderr, "%s is not driven: add it to kMethods, and a seed\n",
                     name.c_str());
        std::abort();
      }
    }
  }
  require(methods == kMethods.size());
}

template <class Time>
void require_within_range(const pb::Message& message) {
  if (message.GetDescriptor() != Time::descriptor()) return;
  const auto& time = static_cast<const Time&>(message);
  const Time bounded = within_range(time);
  require(bounded.seconds() == time.seconds() && bounded.nanos() == time.nanos());
}

/// What the wire can say in every language.
void check_answer(pb::Message& answer) {
  for_each_message(answer, [](const pb::Message& message) {
    require_within_range<pb::Timestamp>(message);
    require_within_range<pb::Duration>(message);
  });
}

std::string bytes_of(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  require(buffer.Dump(&slices).ok());
  std::string bytes;
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

}  // namespace

const pb::MethodDescriptor& method_of(std::string_view name) {
  const auto* const method =
      pb::DescriptorPool::generated_pool()->FindMethodByName(std::string(name));
  require(method != nullptr);
  return *method;
}

std::unique_ptr<pb::Message> message_of(const pb::Descriptor& type) {
  const auto* const prototype = pb::MessageFactory::generated_factory()->GetPrototype(&type);
  return std::unique_ptr<pb::Message>(prototype->New());
}

std::string grid_name_of(std::string_view content) {
  Sha256 sha256;
  sha256.add(content);
  return absl::StrCat("grids/", sha256.finish_hex());
}

std::string ball_file() {
  std::string file("\x93NUMPY\x01\x00\x76\x00", 10);
  std::string head = absl::StrCat("{'descr': '<f4', 'fortran_order': False, 'shape': (", kEdge,
                                  ", ", kEdge, ", ", kEdge, "), }");
  head.resize(0x75, ' ');
  file += head + "\n";
  for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
    const int column = i / kEdge;
    const auto from_middle = [](int place) { return place - (kEdge - 1) / 2.0; };
    const double x = from_middle(i % kEdge), y = from_middle(column % kEdge),
                 z = from_middle(column / kEdge);
    const auto phi = static_cast<float>(std::sqrt(x * x + y * y + z * z) - 4);
    file.append(reinterpret_cast<const char*>(&phi), sizeof phi);
  }
  return file;
}

std::string labels_file() {
  std::string file = absl::StrCat("NRRD0004\ntype: uint8\ndimension: 3\nsizes: ", kEdge, " ",
                                  kEdge, " ", kEdge, "\nencoding: raw\nendian: little\n\n");
  for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
    file.push_back(static_cast<char>(i / kEdge / kEdge / 4));
  }
  return file;
}

Services::Services() {
  check_methods();
  std::string folder = (std::filesystem::temp_directory_path() / "services-XXXXXX").string();
  require(::mkdtemp(folder.data()) != nullptr);
  folder_ = folder;
  start_logging("critical");
  start();
  for (const std::string& file : {ball_file(), labels_file()}) upload(file);
}

Services::~Services() {
  channel_.reset();
  server_.reset();
  std::filesystem::remove_all(folder_);
}

void Services::restart() {
  channel_.reset();
  server_.reset();
  start();
}

Answer Services::call(const pb::MethodDescriptor& method,
                      const std::vector<std::string>& messages,
                      Clock::time_point deadline,
                      std::size_t most_answers) {
  Answer answer;
  grpc::ClientContext context;
  context.set_deadline(deadline);
  const std::string path = absl::StrCat("/", method.service()->full_name(), "/", method.name());
  const grpc::internal::RpcMethod rpc(path.c_str(), grpc::internal::RpcMethod::BIDI_STREAMING);
  using Factory = grpc::internal::ClientReaderWriterFactory<grpc::ByteBuffer, grpc::ByteBuffer>;
  const std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> stream(
      Factory::Create(channel_.get(), rpc, &context));
  for (const std::string& message : messages) {
    const grpc::Slice slice(message);
    if (!stream->Write(grpc::ByteBuffer(&slice, 1))) break;
  }
  stream->WritesDone();
  for (grpc::ByteBuffer buffer; stream->Read(&buffer);) {
    auto message = message_of(*method.output_type());
    require(message->ParseFromString(bytes_of(buffer)));
    check_answer(*message);
    answer.messages.push_back(std::move(message));
    if (answer.messages.size() == most_answers) context.TryCancel();
  }
  answer.status = stream->Finish();
  if (!answer.messages.empty()) answered_.insert(method.full_name());
  return answer;
}

void Services::check_all_answered() const {
  for (const char* const method : kMethods) {
    if (!answered_.contains(method)) {
      std::fprintf(stderr, "no first input has an answer of %s\n", method);
    }
  }
  require(answered_.size() == kMethods.size());
}

std::unique_ptr<pb::Message> Services::answer_to(const char* method,
                                                 const pb::Message& request) {
  Answer answer =
      call(method_of(method), {request.SerializeAsString()}, Clock::now() + kGenerous);
  if (!answer.status.ok() || answer.messages.size() != 1) {
    std::fprintf(stderr, "%s: %s\n", method, answer.status.error_message().c_str());
    std::abort();
  }
  return std::move(answer.messages.front());
}

void Services::start() {
  Config config;
  config.listen = "127.0.0.1:0";
  config.store = folder_ + "/store";
  config.decoder = TETSTREAM_DECODER_PATH;
  config.threads = 2;
  config.job_workers = 1;
  config.decoders = 1;
  config.plan_seconds = config.queue_seconds = kPatienceSeconds;
  config.session_idle_seconds = kPatienceSeconds;
  // The first files are uploaded, and looked into, in any case.
  config.decode_seconds = config.stall_seconds = kGenerous.count();
  config.resident_bytes = config.plan_bytes = std::uint64_t{32} << 20;
  config.send_bytes = config.receive_bytes = std::uint64_t{16} << 20;
  config.store_bytes = config.result_bytes = std::uint64_t{64} << 20;
  config.max_tets = 100'000;
  auto server = Server::start(config);
  if (!server.ok()) std::fprintf(stderr, "%s\n", server.status().ToString().c_str());
  require(server.ok());
  server_ = *std::move(server);
  // What `contain` stops answers nobody, and is a fault all the same.
  tell_exceptions([](const char* where, const std::string& what) {
    std::fprintf(stderr, "%s threw: %s\n", where, what.c_str());
    std::abort();
  });
  channel_ = grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials());
}

void Services::upload(const std::string& file) {
  v1::UploadGridRequest start, data;
  start.mutable_start()->set_name(grid_name_of(file));
  start.mutable_start()->set_size_bytes(static_cast<std::int64_t>(file.size()));
  data.mutable_data()->set_data(file);
  const Answer answer =
      call(method_of("tetstream.v1.GridService.UploadGrid"),
           {start.SerializeAsString(), data.SerializeAsString()}, Clock::now() + kGenerous);
  require(answer.status.ok());
  v1::GetGridInfoRequest info;
  info.set_name(start.start().name());
  ask<v1::GridFile>("tetstream.v1.GridService.GetGridInfo", info);
}

}  // namespace tet::services_fuzz
