// Every number of every message of every method, as extreme as its type allows: each call is
// answered, and the server lives on, and starts again on what it has stored.
#include "tests/server/extreme_numbers.h"

#include <csignal>
#include <functional>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/job_server.h"
#include "tests/server/open_upload.h"
#include "tests/server/reason_of.h"
#include "tests/server/until_healthy.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

using google::protobuf::Message;
using grpc::StatusCode;

/// One method: a request of it that is sound, and how it is made.
struct Method {
  std::shared_ptr<Message> seed;
  std::function<grpc::Status(grpc::ClientContext&, const Message&)> call;
};

template <class Request>
std::shared_ptr<Message> seed_of(const Request& request) {
  return std::make_shared<Request>(request);
}

template <class Service, class Request, class Response>
Method unary(const std::unique_ptr<typename Service::Stub>& stub,
             grpc::Status (Service::Stub::*method)(grpc::ClientContext*,
                                                   const Request&,
                                                   Response*),
             const Request& seed) {
  return {seed_of(seed), [&stub, method](grpc::ClientContext& context, const Message& request) {
            Response response;
            return (stub.get()->*method)(&context, static_cast<const Request&>(request),
                                         &response);
          }};
}

template <class Service, class Request, class Event>
Method reader(const std::unique_ptr<typename Service::Stub>& stub,
              std::unique_ptr<grpc::ClientReader<Event>> (Service::Stub::*method)(
                  grpc::ClientContext*, const Request&),
              const Request& seed) {
  return {seed_of(seed), [&stub, method](grpc::ClientContext& context, const Message& request) {
            const auto events =
                (stub.get()->*method)(&context, static_cast<const Request&>(request));
            for (Event event; events->Read(&event);) {
            }
            return events->Finish();
          }};
}

class ExtremeNumbers : public testing::Test {
 protected:
  ExtremeNumbers() {
    start();
    ball_ = server_.ball(2);
    done_ = server_.wait(server_.create(ball_));
    stopped_ = server_.cancel(server_.create(ball_));
    add_methods();
  }

  void start() { server_.start({"--job-workers", "1", "--max-tets", "100000"}); }

  void add_methods() {
    using v1::GridService;
    using v1::JobService;
    using v1::MeshService;
    v1::CreateJobRequest create;
    *create.mutable_job() = ball_;
    v1::WaitJobRequest wait;
    wait.set_name(done_.name());
    v1::ListDeadShardsRequest dead;
    dead.set_name(stopped_.name());
    v1::ReadJobResultRequest read;
    read.set_name(done_.name());
    v1::EstimateMeshRequest estimate;
    *estimate.mutable_mesh() = ball_.mesh();
    v1::StreamMeshRequest stream;
    *stream.mutable_mesh() = ball_.mesh();
    methods_ = {
        {"CreateJob", unary<JobService>(server_.jobs, &JobService::Stub::CreateJob, create)},
        {"ListJobs",
         unary<JobService>(server_.jobs, &JobService::Stub::ListJobs, v1::ListJobsRequest())},
        {"WaitJob", unary<JobService>(server_.jobs, &JobService::Stub::WaitJob, wait)},
        {"ListDeadShards",
         unary<JobService>(server_.jobs, &JobService::Stub::ListDeadShards, dead)},
        {"ListWorkers", unary<JobService>(server_.jobs, &JobService::Stub::ListWorkers,
                                          v1::ListWorkersRequest())},
        {"WatchJobs", watch()},
        {"ReadJobResult",
         reader<JobService>(server_.jobs, &JobService::Stub::ReadJobResult, read)},
        {"ListGrids", unary<GridService>(server_.grids, &GridService::Stub::ListGrids,
                                         v1::ListGridsRequest())},
        {"UploadGrid", upload()},
        {"EstimateMesh",
         unary<MeshService>(server_.meshes, &MeshService::Stub::EstimateMesh, estimate)},
        {"StreamMesh",
         reader<MeshService>(server_.meshes, &MeshService::Stub::StreamMesh, stream)},
        {"RemeshSession", session()},
        {"SamplePoints", samples()},
    };
  }

  /// Ends with the first event: there is always one after a revision that the store knows.
  Method watch() {
    v1::WatchJobsRequest seed;
    seed.set_name(done_.name());
    return {seed_of(seed), [this](grpc::ClientContext& context, const Message& request) {
              const auto events = server_.jobs->WatchJobs(
                  &context, static_cast<const v1::WatchJobsRequest&>(request));
              v1::JobEvent event;
              const bool any = events->Read(&event);
              if (any) context.TryCancel();
              const grpc::Status status = events->Finish();
              return any ? grpc::Status::OK : status;
            }};
  }

  Method upload() {
    const std::string text = "five!";
    v1::UploadGridRequest start;
    start.mutable_start()->set_name(grid_name_of(text));
    start.mutable_start()->set_size_bytes(5);
    return {seed_of(v1::UploadGridRequest()),
            [this, start](grpc::ClientContext& context, const Message& request) {
              auto message = static_cast<const v1::UploadGridRequest&>(request);
              if (message.has_start()) message.mutable_start()->set_name(start.start().name());
              v1::UploadGridResponse response;
              const auto writer = server_.grids->UploadGrid(&context, &response);
              if (message.has_data()) {
                message.mutable_data()->set_data("fi");
                writer->Write(start);
              }
              writer->Write(message);
              writer->WritesDone();
              return writer->Finish();
            }};
  }

  /// A frame comes after a start that it goes with.
  Method session() {
    return {seed_of(v1::RemeshRequest()),
            [this](grpc::ClientContext& context, const Message& request) {
              auto message = static_cast<const v1::RemeshRequest&>(request);
              const auto stream = server_.meshes->RemeshSession(&context);
              if (message.has_frame()) {
                stream->Write(start_for(message.frame()));
                for (v1::LeafUpdate& leaf : *message.mutable_frame()->mutable_leaves()) {
                  leaf.set_values(std::string(sizeof(float), '\0'));
                }
              } else if (!message.start().has_scene()) {
                message.mutable_start()->set_name(ball_.mesh().name());
              }
              stream->Write(message);
              stream->WritesDone();
              for (v1::MeshEvent event; stream->Read(&event);) {
              }
              return stream->Finish();
            }};
  }

  /// Points come after a start.
  Method samples() {
    return {seed_of(v1::SamplePointsRequest()),
            [this](grpc::ClientContext& context, const Message& request) {
              auto message = static_cast<const v1::SamplePointsRequest&>(request);
              const auto stream = server_.meshes->SamplePoints(&context);
              if (!message.has_start()) {
                v1::SamplePointsRequest start;
                *start.mutable_start() = ball_.mesh();
                stream->Write(start);
              } else if (!message.start().has_scene()) {
                message.mutable_start()->set_name(ball_.mesh().name());
              }
              stream->Write(message);
              stream->WritesDone();
              for (v1::SamplePointsResponse response; stream->Read(&response);) {
              }
              return stream->Finish();
            }};
  }

  v1::RemeshRequest start_for(const v1::RemeshFrame& frame) const {
    v1::RemeshRequest start;
    *start.mutable_start() = ball_.mesh();
    if (!frame.has_scene()) return start;
    start.mutable_start()->clear_name();
    start.mutable_start()->set_spacing(0.25);
    start.mutable_start()->mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
    return start;
  }

  /// The answer, which is no word of a server that is gone, or does not know what to say.
  void expect_answer(const std::string& method,
                     const Message& request,
                     const std::string& what) {
    const grpc::Status status = asked_until_healthy([&] {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + kGenerousEnd);
      return methods_.at(method).call(context, request);
    });
    ++answers_[status.error_code()];
    EXPECT_THAT(
        status.error_code(),
        testing::AnyOf(StatusCode::OK, StatusCode::INVALID_ARGUMENT, StatusCode::OUT_OF_RANGE,
                       StatusCode::FAILED_PRECONDITION, StatusCode::RESOURCE_EXHAUSTED))
        << method << ": " << what << ": " << status.error_message();
    if (status.error_code() == StatusCode::INVALID_ARGUMENT) {
      EXPECT_NE(reason_of(status), "tetstream/") << method << ": " << what;
    }
  }

  /// All jobs are told of, together and, unless that says enough, one by one.
  std::set<std::string> expect_all_jobs(bool one_by_one = true) {
    std::set<std::string> names;
    v1::ListJobsRequest request;
    do {
      grpc::ClientContext context;
      v1::ListJobsResponse page;
      const grpc::Status status = server_.jobs->ListJobs(&context, request, &page);
      EXPECT_TRUE(status.ok()) << status.error_message();
      for (const v1::Job& job : page.jobs()) {
        names.insert(job.name());
        if (one_by_one) {
          EXPECT_EQ(server_.get(job).name(), job.name());
        }
      }
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
    return names;
  }

  bool lives() const { return ::kill(server_.process->pid(), 0) == 0; }

  JobServer server_{TETSTREAMD_PATH};
  v1::Job ball_, done_, stopped_;
  std::map<std::string, Method> methods_;
  std::map<StatusCode, int> answers_;
};

TEST_F(ExtremeNumbers, OfEveryMessageAreAnsweredAndEndNoServer) {
  for (const auto& entry : methods_) {  // Clang 14 lets no lambda capture a structured binding.
    const std::string& name = entry.first;
    for_each_extreme(*entry.second.seed, [&](const Message& request, const std::string& what) {
      if (!HasFatalFailure() && !HasNonfatalFailure()) expect_answer(name, request, what);
    });
    ASSERT_FALSE(HasFailure()) << name;
    expect_all_jobs(name == "CreateJob");  // no other method leaves more or other jobs
    ASSERT_TRUE(lives()) << name;
  }
  EXPECT_GT(answers_[StatusCode::OK], 100);
  EXPECT_GT(answers_[StatusCode::INVALID_ARGUMENT], 1000);
  const std::set<std::string> before = expect_all_jobs();
  start();
  EXPECT_EQ(expect_all_jobs(), before);
}

TEST_F(ExtremeNumbers, AreTriedOnEveryMethodThatTakesAny) {
  for (const auto* file : {v1::GridFile::descriptor()->file(), v1::Job::descriptor()->file(),
                           v1::MeshRequest::descriptor()->file()}) {
    for (int s = 0; s < file->service_count(); ++s) {
      const auto& service = *file->service(s);
      for (int m = 0; m < service.method_count(); ++m) {
        const auto& method = *service.method(m);
        EXPECT_EQ(methods_.contains(method.name()), has_numbers(*method.input_type()))
            << method.full_name();
      }
    }
  }
}

TEST_F(ExtremeNumbers, EndNoServerThatKeepsAJobOfTenThousandYears) {
  v1::Job job = ball_;
  job.mutable_ttl()->set_seconds(315'576'000'000);
  server_.create(job);
  EXPECT_EQ(reason_of(server_.status), "tetstream/INVALID_FIELD");
  EXPECT_EQ(server_.status.error_message(),
            "ttl 87660000h is more than 876000h, a hundred years: leave it out for no end");
  job = ball_;
  job.mutable_timeout()->set_seconds(315'576'000'000);
  server_.create(job);
  EXPECT_EQ(server_.status.error_message(),
            "timeout 87660000h is more than 876000h, a hundred years: leave it out for no end");
  job.mutable_timeout()->set_seconds(std::int64_t{876'000} * 3600);
  *job.mutable_ttl() = job.timeout();
  const v1::Job longest = server_.create(job);
  EXPECT_TRUE(server_.status.ok()) << server_.status.error_message();
  EXPECT_EQ(server_.wait(longest).state(), v1::JOB_STATE_SUCCEEDED);
  start();
  EXPECT_TRUE(expect_all_jobs().contains(longest.name()));
}

}  // namespace
}  // namespace tet::test
