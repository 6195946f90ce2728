#include "server/grids/upload_events.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

constexpr unsigned kAll =
    UploadEvents::kMessage | UploadEvents::kWritten | UploadEvents::kDigested;

TEST(UploadEvents, GiveTheTurnToTheLastInAnyOrder) {
  UploadEvents events;
  events.await(kAll);
  EXPECT_FALSE(events.happened(UploadEvents::kWritten));
  EXPECT_FALSE(events.happened(UploadEvents::kMessage));
  EXPECT_TRUE(events.happened(UploadEvents::kDigested));
  events.await(UploadEvents::kMessage);
  EXPECT_TRUE(events.happened(UploadEvents::kMessage));
}

TEST(UploadEvents, AreGivenUpWhereOnlyTheMessageIsMissing) {
  UploadEvents events;
  events.await(kAll);
  EXPECT_FALSE(events.give_up());
  EXPECT_FALSE(events.happened(UploadEvents::kWritten));
  EXPECT_FALSE(events.give_up());
  EXPECT_FALSE(events.happened(UploadEvents::kDigested));
  EXPECT_TRUE(events.give_up());
  EXPECT_FALSE(events.happened(UploadEvents::kMessage)) << "somebody else had the turn";
}

// The digest would go on in an upload that is no longer there.
TEST(UploadEvents, AreNotGivenUpWhileThePieceIsInWork) {
  for (const auto last : {UploadEvents::kDigested, UploadEvents::kWritten}) {
    UploadEvents events;
    events.await(kAll);
    for (const auto event :
         {UploadEvents::kMessage, UploadEvents::kWritten, UploadEvents::kDigested}) {
      if (event == last) continue;
      EXPECT_FALSE(events.happened(event));
    }
    EXPECT_FALSE(events.give_up()) << "one event is missing, and it is not the message";
    EXPECT_TRUE(events.happened(last));
  }
}

}  // namespace
}  // namespace tet
