// The program as an operator meets it.
#include <algorithm>
#include <chrono>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/library/mesh_client.h"
#include "tests/server/port_file.h"
#include "tests/server/program.h"
#include "tests/server/test_folder.h"
#include "tests/support/unused_port.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

class TetstreamdTest : public testing::Test {
 protected:
  using Environment = std::map<std::string, std::string>;

  struct Ended {
    int exit_code;
    std::string out, err;
  };

  Ended run(std::vector<std::string> arguments, const Environment& environment = {}) {
    arguments.insert(arguments.begin(), TETSTREAMD_PATH);
    Program program(folder_, std::move(arguments), environment);
    const int exit_code = program.wait();
    return {exit_code, program.out(), program.err()};
  }

  /// A server, on a free port unless told, and its address, once it serves.
  std::unique_ptr<Program> serve(const std::string& listen = "127.0.0.1:0") {
    const std::string port_file = folder_.file("port");
    std::filesystem::remove(port_file);
    auto program = std::make_unique<Program>(
        folder_, std::vector<std::string>{TETSTREAMD_PATH, "--listen", listen, "--store",
                                          folder_.file("store"), "--port-file", port_file,
                                          "--threads", "2"});
    const std::string port = port_in(port_file);
    EXPECT_FALSE(port.empty()) << program->err();
    address_ = "127.0.0.1:" + port;
    return program;
  }

  TestFolder folder_;
  std::string address_;
  Cancellation never_;
};

TEST_F(TetstreamdTest, PrintsItsVersionAndTeachesItsUse) {
  const Ended version = run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, HasSubstr("tetstreamd "));
  const Ended help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("TETSTREAM_STORE_BYTES"));
}

TEST_F(TetstreamdTest, TakesFlagsBeforeEnvironmentBeforeFileBeforeDefaults) {
  const std::string file =
      folder_.write("c.toml", "threads = 1\nmax_streams = 1\ndrain_seconds = 1\n");
  const Ended printed = run({"--config", file, "--threads", "3", "--print-config"},
                            {{"TETSTREAM_THREADS", "2"}, {"TETSTREAM_MAX_STREAMS", "2"}});
  EXPECT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("\nthreads = 3\n"));
  EXPECT_THAT(printed.out, HasSubstr("\nmax_streams = 2\n"));
  EXPECT_THAT(printed.out, HasSubstr("\ndrain_seconds = 1\n"));
  EXPECT_THAT(printed.out, HasSubstr("\nmax_tets = 4000000000\n"));
}

TEST_F(TetstreamdTest, RefusesABadConfigFileByNameAndLine) {
  const Ended ended = run({"--config", folder_.write("c.toml", "\nstroe = \"x\"\n")});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("c.toml:2: unknown key \"stroe\""));
}

TEST_F(TetstreamdTest, RefusesABadValueOfAFlag) {
  const Ended ended = run({"--max-streams", "none"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("--max-streams"));
}

TEST_F(TetstreamdTest, CallsAnUnknownOptionWrongUsage) {
  const Ended ended = run({"--stroe", "x"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("--stroe"));
}

TEST_F(TetstreamdTest, TakesNoOptionForTheValueOfAnother) {
  const Ended swallowing = run({"--log-level=", "--print-config"});
  EXPECT_EQ(swallowing.exit_code, 2);
  EXPECT_THAT(swallowing.err, HasSubstr("--log-level has nothing behind its ="));
  const Ended empty = run({"--http-listen", "", "--print-config"});
  EXPECT_EQ(empty.exit_code, 0) << empty.err;
}

TEST_F(TetstreamdTest, SaysWhenItCannotListen) {
  const auto first = serve();
  const TestFolder other;
  const Ended second = run({"--listen", address_, "--store", other.file("store")});
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_THAT(second.err, HasSubstr("cannot listen on " + address_));
}

TEST_F(TetstreamdTest, NamesTheJobFileThatItCannotOpen) {
  const std::string jobs = folder_.write("jobs", std::string(8192, 'x'));
  const Ended ended =
      run({"--listen", "127.0.0.1:0", "--store", folder_.file("store"), "--jobs", jobs});
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_THAT(ended.err, HasSubstr("the jobs in '" + jobs + "' cannot be opened"));
}

TEST_F(TetstreamdTest, KeepsItsGridsOverASigtermAndARestart) {
  const std::string ball = folder_.file("ball.vdb");
  write_fixture("sphere", 0.125, ball);
  auto first = serve();
  const auto name = MeshClient::connect(address_)->upload_file(ball, {}, never_);
  ASSERT_TRUE(name.ok()) << name.status();
  first->send(SIGTERM);
  EXPECT_EQ(first->wait(), 0);

  const auto second = serve();
  const auto files = MeshClient::connect(address_)->list_grids(never_);
  ASSERT_TRUE(files.ok()) << files.status();
  ASSERT_EQ(files->size(), 1U);
  EXPECT_EQ(files->front().name(), *name);
  v1::MeshRequest request;
  request.set_name(*name);
  EXPECT_TRUE(MeshClient::connect(address_)->stream_mesh(request, {}, never_).ok());
}

// Within four seconds: gRPC by itself looks every five. Servers in the client's own process
// would look for it.
TEST_F(TetstreamdTest, IsFoundAgainByAClientBeforeThatGivesUp) {
  const UnusedPort port;
  auto first = serve(port.address());
  const auto client = MeshClient::connect(address_, {.attempts = 20,
                                                     .attempts_once_known = 20,
                                                     .first_backoff_ms = 200,
                                                     .max_backoff_ms = 200});
  ASSERT_TRUE(client->capabilities(never_).ok());
  first->send(SIGKILL);
  first->wait();
  const Cancellation soon(std::chrono::system_clock::now() + 300ms);
  EXPECT_FALSE(client->capabilities(soon).ok());
  const auto second = serve(port.address());
  const absl::Status status = client->capabilities(never_).status();
  EXPECT_TRUE(status.ok()) << status;
}

TEST_F(TetstreamdTest, NeverLoadsOpenVdb) {
  const std::string ball = folder_.file("ball.vdb");
  write_fixture("sphere", 0.125, ball);
  const auto server = serve();
  const auto client = MeshClient::connect(address_);
  const auto name = client->upload_file(ball, {}, never_);
  ASSERT_TRUE(name.ok()) << name.status();
  v1::MeshRequest request;
  request.set_name(*name);
  EXPECT_TRUE(client->grid_info(*name, never_).ok());
  EXPECT_TRUE(client->stream_mesh(request, {}, never_).ok());
  const std::string maps = read_text("/proc/" + std::to_string(server->pid()) + "/maps");
  EXPECT_THAT(maps, HasSubstr("libgrpc"));
  EXPECT_THAT(maps, Not(HasSubstr("openvdb")));
}

TEST_F(TetstreamdTest, LogsOneJsonObjectALine) {
  auto server = serve();
  v1::MeshRequest nothing;
  EXPECT_FALSE(MeshClient::connect(address_)->estimate(nothing, never_).ok());
  server->send(SIGINT);
  EXPECT_EQ(server->wait(), 0);
  // Others are told where a disk or a decoder does not answer for seconds.
  const std::vector<std::string> expected = {"serving", "call", "draining", "stopped"};
  std::vector<std::string> events;
  std::istringstream lines(server->err());
  for (std::string line; std::getline(lines, line);) {
    const auto object = nlohmann::json::parse(line);
    const std::string event = object.at("event");
    if (std::ranges::count(expected, event) > 0) events.push_back(event);
    if (event != "call") continue;
    EXPECT_EQ(object.at("method"), "EstimateMesh");
    EXPECT_EQ(object.at("status"), "INVALID_ARGUMENT");
    EXPECT_TRUE(object.at("duration_ms").is_number());
    EXPECT_FALSE(object.at("request_id").get<std::string>().empty());
  }
  // The port can be had, and called, before the event that says so.
  ASSERT_EQ(events.size(), 4U);
  EXPECT_THAT(std::vector(events.begin(), events.begin() + 2),
              testing::UnorderedElementsAre("serving", "call"));
  EXPECT_THAT(std::vector(events.begin() + 2, events.end()),
              testing::ElementsAre("draining", "stopped"));
}

}  // namespace
}  // namespace tet::test
