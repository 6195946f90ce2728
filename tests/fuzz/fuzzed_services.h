// Whole services in one process, over a store of their own, and calls of any of their methods.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <google/protobuf/message.h>
#include <grpcpp/channel.h>
#include <grpcpp/support/status.h>

#include "server/server.h"

namespace tet::services_fuzz {

namespace pb = google::protobuf;
using Clock = std::chrono::system_clock;

/// An input names a method by its place here: new ones are added at the end.
inline constexpr std::array kMethods{"tetstream.v1.GridService.FindMissingGrids",
                                     "tetstream.v1.GridService.UploadGrid",
                                     "tetstream.v1.GridService.GetUploadStatus",
                                     "tetstream.v1.GridService.ListGrids",
                                     "tetstream.v1.GridService.GetGridInfo",
                                     "tetstream.v1.MeshService.GetCapabilities",
                                     "tetstream.v1.MeshService.EstimateMesh",
                                     "tetstream.v1.MeshService.StreamMesh",
                                     "tetstream.v1.MeshService.RemeshSession",
                                     "tetstream.v1.MeshService.SamplePoints",
                                     "tetstream.v1.JobService.CreateJob",
                                     "tetstream.v1.JobService.GetJob",
                                     "tetstream.v1.JobService.ListJobs",
                                     "tetstream.v1.JobService.WatchJobs",
                                     "tetstream.v1.JobService.WaitJob",
                                     "tetstream.v1.JobService.CancelJob",
                                     "tetstream.v1.JobService.RetryJob",
                                     "tetstream.v1.JobService.DeleteJob",
                                     "tetstream.v1.JobService.ListDeadShards",
                                     "tetstream.v1.JobService.ReadJobResult",
                                     "tetstream.v1.JobService.ListWorkers",
                                     "grpc.health.v1.Health.Check",
                                     "grpc.health.v1.Health.Watch"};

const pb::MethodDescriptor& method_of(std::string_view name);

/// An empty message of that type.
std::unique_ptr<pb::Message> message_of(const pb::Descriptor& type);

/// Calls `see(message)` for it, and for each message within it.
template <class See>
void for_each_message(pb::Message& message, const See& see) {
  see(message);
  std::vector<const pb::FieldDescriptor*> fields;
  const pb::Reflection& reflection = *message.GetReflection();
  reflection.ListFields(message, &fields);
  for (const auto* field : fields) {
    if (field->message_type() == nullptr) continue;
    if (!field->is_repeated()) {
      for_each_message(*reflection.MutableMessage(&message, field), see);
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      for_each_message(*reflection.MutableRepeatedMessage(&message, field, i), see);
    }
  }
}

std::string grid_name_of(std::string_view content);

/// A NumPy file of a ball's level set.
std::string ball_file();

/// An NRRD file of three labels in layers.
std::string labels_file();

inline constexpr std::size_t kMostAnswers = 64;

/// What came of a call: its messages have been read, and are within what the wire can say.
struct Answer {
  grpc::Status status;
  std::vector<std::unique_ptr<pb::Message>> messages;
};

/// A server whose limits are small. Its store has the two files above.
class Services {
 public:
  /// Ends the process where the services have a method that is not in kMethods.
  Services();
  ~Services();
  Services(const Services&) = delete;
  Services& operator=(const Services&) = delete;

  /// Another server, over the same store.
  void restart();

  /// Ends the process where no call of a method has been answered by a message.
  void check_all_answered() const;

  /// Sends the messages, and takes what comes until the call ends or so many have come.
  Answer call(const pb::MethodDescriptor& method,
              const std::vector<std::string>& messages,
              Clock::time_point deadline,
              std::size_t most_answers = kMostAnswers);

  /// The only message of an answer that there has to be.
  template <class Response>
  Response ask(const char* method, const pb::Message& request) {
    return static_cast<const Response&>(*answer_to(method, request));
  }

 private:
  void start();
  void upload(const std::string& file);
  std::unique_ptr<pb::Message> answer_to(const char* method, const pb::Message& request);

  std::string folder_;
  std::set<std::string> answered_;  ///< methods
  std::unique_ptr<Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace tet::services_fuzz
