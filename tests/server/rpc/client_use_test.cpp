#include "server/rpc/client_use.h"

#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "server/rpc/background.h"
#include "server/rpc/fair_tasks.h"

namespace tet {
namespace {

std::set<std::string> clients_told(const ClientUse& use) {
  std::set<std::string> clients;
  for (const Reading& reading : use.readings()) clients.insert(reading.labels.at(0).second);
  return clients;
}

double told(const ClientUse& use, const std::string& name, const std::string& client) {
  for (const Reading& reading : use.readings()) {
    if (reading.name == name && reading.labels.at(0).second == client) return reading.value;
  }
  return -1;
}

TEST(ClientUse, IsToldByNamesThatAnOperatorHasGivenAndOfAllOthersTogether) {
  ClientUse use;
  use.name("alice").sent_bytes += 7;
  ++use.of("alice").calls;
  for (int i = 0; i < 1000; ++i) ++use.of("10.0.0." + std::to_string(i)).calls;
  EXPECT_EQ(clients_told(use), (std::set<std::string>{"(others)", "alice"}));
  EXPECT_EQ(told(use, "tetstream_client_sent_bytes_total", "alice"), 7);
  EXPECT_EQ(told(use, "tetstream_client_calls_total", "alice"), 1);
  EXPECT_EQ(told(use, "tetstream_client_calls_total", ClientUse::kOthers), 1000);
}

TEST(ClientUse, IsOfAFewNamesHoweverManyThereAre) {
  ClientUse use;
  for (int i = 0; i < 1000; ++i) ++use.name("CN=" + std::to_string(i)).calls;
  EXPECT_EQ(clients_told(use).size(), ClientUse::kMostNames + 1);
  EXPECT_EQ(told(use, "tetstream_client_calls_total", ClientUse::kOthers),
            1000 - double{ClientUse::kMostNames});
  EXPECT_EQ(told(use, "tetstream_client_calls_total", "CN=0"), 1);
}

TEST(ClientUse, HasOneSeriesForNamesThatAreToldAlike) {
  ClientUse use;
  const std::string longest(1000, 'a');
  for (const std::string& name : {longest + "b", longest + "c"}) ++use.name(name).calls;
  for (const char* const name : {"CN=\xff", "CN=\xfe", "CN=\n"}) ++use.name(name).calls;
  std::set<std::pair<std::string, std::string>> series;
  for (const Reading& reading : use.readings()) {
    EXPECT_TRUE(series.emplace(reading.name, reading.labels.at(0).second).second);
  }
  EXPECT_EQ(told(use, "tetstream_client_calls_total", "CN=?"), 3);
}

TEST(ClientUse, HasTheTimeOfTasksWhoseverTheyAre) {
  ClientUse use;
  use.name("alice");
  const std::string jobs = background_client("team");
  auto pool = std::make_unique<TaskPool>(2);
  FairTasks tasks(*pool, &use);
  const auto nap = [] { std::this_thread::sleep_for(std::chrono::milliseconds(2)); };
  for (const std::string& client : {std::string("alice"), std::string("127.0.0.1"), jobs}) {
    tasks.post(client, nap);
  }
  pool.reset();  // when all are done
  const char* const name = "tetstream_client_work_seconds_total";
  for (const std::string& client :
       {std::string("alice"), std::string(ClientUse::kOthers), jobs}) {
    EXPECT_GE(told(use, name, client), 0.002) << client;
  }
}

}  // namespace
}  // namespace tet
