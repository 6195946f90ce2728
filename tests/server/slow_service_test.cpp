// One program for the tests of the service that take seconds each: linking one takes as long as
// compiling a few of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/parallel.h"

// Servers write TLS on worker threads, which are to be gone before the process is.
int main(int argc, char** argv) {
  const tet::WorkerThreads workers;
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
