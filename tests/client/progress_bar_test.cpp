#include "client/command/process/progress_bar.h"

#include <gmock/gmock.h>

namespace tet {
namespace {

TEST(ProgressLine, TellsStageShareRateAndTimeLeft) {
  EXPECT_EQ(progress_line("meshing", "tets", 1.5e6, 3e6, 2),
            "meshing   [###############...............]  50%  750k tets/s  0:02 left");
}

TEST(ProgressLine, CountsMinutesWhenItTakesThem) {
  EXPECT_THAT(progress_line("uploading", "B", 1e9, 1e11, 10),
              ::testing::EndsWith("16:30 left"));
}

TEST(ProgressLine, SaysOnlyTheStageWhileTheTotalIsUnknown) {
  EXPECT_EQ(progress_line("planning", "bricks", 0, 0, 5), "planning ...");
}

TEST(ProgressLine, LeavesOutTheRateWithoutAUnitAndBeforeItIsKnown) {
  EXPECT_EQ(progress_line("writing", "", 1, 4, 0.1),
            "writing   [#######.......................]  25%");
  EXPECT_EQ(progress_line("writing", "", 1, 4, 3),
            "writing   [#######.......................]  25%  0:09 left");
}

TEST(ProgressLine, StaysWithinTheBarWhateverItIsTold) {
  EXPECT_EQ(progress_line("meshing", "", 9, 4, 0),
            "meshing   [##############################] 100%");
}

}  // namespace
}  // namespace tet
