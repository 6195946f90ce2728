// What a client believes of a server that hands it memory.
#include "client/library/shared_chunks.h"

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <functional>
#include <sys/mman.h>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/mesh_receiver.h"
#include "core/base/posix/packet_socket.h"
#include "proto/wire/checksum.h"
#include "proto/wire/shared_columns.h"
#include "proto/wire/side_messages.h"
#include "tests/support/eventually.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

constexpr std::int64_t kBlock = 4096, kBlocks = 2;

/// A server that says what the test wants.
class SharedChunksTest : public testing::Test {
 protected:
  SharedChunksTest()
      : listener_(listen_for_packets(path_ + kSideSocketEnding, 4)),
        memory_(*SealedMemory::make(kBlock * kBlocks)) {}

  /// Answers for several chunks, and waits for the server, however slow we are.
  static SharedChunks patient(std::chrono::milliseconds answers_within = test::kGenerousEnd) {
    return SharedChunks(answers_within, test::kGenerousEnd);
  }

  /// The client connects and is told a token.
  void meet() {
    meet_while([&] { EXPECT_EQ(chunks_.begin(path_, never_), token_); });
  }
  void meet_while(const std::function<void()>& client) {
    std::thread server([&] {
      while (!accepted_.is_open()) accepted_ = accept_packets(listener_);
      send_packet(accepted_, std::as_bytes(std::span(token_)));
    });
    client();
    server.join();
  }

  static v1::SharedMemory told(std::int64_t block_bytes = kBlock,
                               std::int64_t blocks = kBlocks) {
    v1::SharedMemory message;
    message.set_block_bytes(block_bytes);
    message.set_blocks(blocks);
    return message;
  }

  /// Where events come here, too.
  void open_for_events(std::int64_t blocks) {
    const SealedMemory memory =
        *SealedMemory::make(static_cast<std::size_t>(kBlock * blocks), Readers::kAny);
    meet();
    v1::SharedMemory message = told(kBlock, blocks);
    message.set_events(true);
    ASSERT_TRUE(hand_over(memory.descriptor(), static_cast<std::uint64_t>(kBlock * blocks)));
    ASSERT_EQ(chunks_.open(message, never_), absl::OkStatus());
  }

  /// Whether an event comes here, which is `bytes`.
  bool takes(const std::string& bytes) {
    grpc::ByteBuffer event;
    if (!chunks_.take_event(event, never_, [] { return false; })) return false;
    grpc::Slice slice;
    EXPECT_TRUE(event.DumpToSingleSlice(&slice).ok());
    EXPECT_EQ(std::string(slice.begin(), slice.end()), bytes);
    return true;
  }
  bool say(const std::string& bytes) const {
    return send_packet(accepted_, std::as_bytes(std::span(bytes)));
  }

  bool hand_over(const Descriptor& memory, std::uint64_t size = kBlock * kBlocks) const {
    return send_packet(accepted_, side_message(size), memory);
  }

  test::TestDirectory folder_;
  const std::string path_ = folder_.file("socket");
  const std::string token_ = "0123456789abcdef";
  const Cancellation never_;
  Descriptor listener_, accepted_;
  SealedMemory memory_;
  SharedChunks chunks_ = patient();
};

TEST_F(SharedChunksTest, CopiesColumnsAndTellsTheirChecksum) {
  meet();
  ASSERT_TRUE(hand_over(memory_.descriptor()));
  ASSERT_EQ(chunks_.open(told(), never_), absl::OkStatus());
  std::array<std::byte, 12> positions{};
  std::array<std::byte, 100> tets{};
  ChunkColumns to{};
  to.positions = positions;
  to.tets = tets;
  const SharedColumns layout({12, 100, 0, 0, 0, 0, 0});
  std::byte* const block = memory_.bytes().data() + kBlock;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::byte& byte : layout.column(block, i)) byte = static_cast<std::byte>(i + 1);
  }
  MeshHeader header;
  header.vertex_count = 0x02020203;
  const auto copied = chunks_.copy(kBlock, to, header);
  ASSERT_TRUE(copied.ok()) << copied.status();
  EXPECT_EQ(copied->checksum, add_to_checksum(add_to_checksum(0, positions), tets));
  EXPECT_TRUE(copied->ids_are_within);
  --header.vertex_count;
  EXPECT_FALSE(chunks_.copy(kBlock, to, header)->ids_are_within);
  EXPECT_EQ(positions[11], std::byte{1});
  EXPECT_EQ(tets[99], std::byte{2});
  chunks_.acknowledge(5);
  SideMessage said{};
  EXPECT_EQ(take_packet(accepted_, said), Packet::kTaken);
  EXPECT_EQ(side_number(said), 5u);
}

TEST_F(SharedChunksTest, AsksForEventsWhereverItAsksForMemory) {
  v1::StreamMeshRequest stream;
  v1::RemeshRequest session;
  meet_while([&] { chunks_.ask(stream, path_, never_); });
  EXPECT_EQ(stream.shared_memory(), token_);
  EXPECT_TRUE(stream.shared_memory_events());
  chunks_ = patient();
  accepted_ = Descriptor();
  meet_while([&] { chunks_.ask(session, path_, never_); });
  EXPECT_EQ(session.shared_memory(), token_);
  EXPECT_TRUE(session.shared_memory_events());
  chunks_.ask(stream, "", never_);  // at a server elsewhere
  EXPECT_EQ(stream.shared_memory(), "");
  EXPECT_FALSE(stream.shared_memory_events());
}

TEST_F(SharedChunksTest, CopiesNothingFromBeyondTheMemory) {
  meet();
  ASSERT_TRUE(hand_over(memory_.descriptor()));
  ASSERT_EQ(chunks_.open(told(), never_), absl::OkStatus());
  std::vector<std::byte> positions(static_cast<std::size_t>(kBlock));
  ChunkColumns to{};
  to.positions = positions;
  EXPECT_TRUE(chunks_.copy(kBlock, to, {}).ok());
  for (const std::int64_t offset :
       {kBlock + 1, 2 * kBlock, 2 * kBlock + 1, std::int64_t{-1}, INT64_MAX, INT64_MIN}) {
    EXPECT_EQ(chunks_.copy(offset, to, {}).status().code(), absl::StatusCode::kDataLoss)
        << offset;
  }
}

TEST_F(SharedChunksTest, TakesNoMemoryThatMayBecomeShorterOrIsNot) {
  const Descriptor unsealed(::memfd_create("unsealed", MFD_CLOEXEC));
  ASSERT_EQ(::posix_fallocate(unsealed.number(), 0, kBlock * kBlocks), 0);
  const SealedMemory shorter = *SealedMemory::make(kBlock);
  for (const Descriptor* memory : {&unsealed, &shorter.descriptor()}) {
    chunks_ = patient();
    accepted_ = Descriptor();
    meet();
    ASSERT_TRUE(hand_over(*memory));
    EXPECT_EQ(chunks_.open(told(), never_).code(), absl::StatusCode::kUnavailable);
    EXPECT_FALSE(chunks_.is_open());
    EXPECT_EQ(chunks_.begin(path_, never_), "");  // not again
  }
}

TEST_F(SharedChunksTest, WantsTheMemoryThatTheHeaderTellsOf) {
  meet();
  ASSERT_TRUE(hand_over(memory_.descriptor(), kBlock));
  EXPECT_EQ(chunks_.open(told(), never_).code(), absl::StatusCode::kUnavailable);
  chunks_ = patient();
  accepted_ = Descriptor();
  meet();
  ASSERT_TRUE(hand_over(Descriptor()));  // no file
  EXPECT_EQ(chunks_.open(told(), never_).code(), absl::StatusCode::kUnavailable);
}

TEST_F(SharedChunksTest, WaitsForNoMemoryOnceItIsCancelled) {
  meet();
  const Cancellation past(Cancellation::Clock::now());
  EXPECT_EQ(chunks_.open(told(), past).code(), absl::StatusCode::kDeadlineExceeded);
  accepted_ = Descriptor();
  meet();
  Cancellation cancellation;
  std::thread leaving([&] { cancellation.cancel(); });
  EXPECT_EQ(chunks_.open(told(), cancellation).code(), absl::StatusCode::kCancelled);
  leaving.join();
  accepted_ = Descriptor();
  meet();  // and works for the next call
  ASSERT_TRUE(hand_over(memory_.descriptor()));
  EXPECT_EQ(chunks_.open(told(), never_), absl::OkStatus());
}

TEST_F(SharedChunksTest, RefusesSizesThatCannotBe) {
  for (const auto& [block_bytes, blocks] : {std::pair<std::int64_t, std::int64_t>{0, 1},
                                            {1, 0},
                                            {-4096, 2},
                                            {4096, -1},
                                            {INT64_MAX, INT64_MAX},
                                            {std::int64_t{1} << 30, 1 << 16}}) {
    chunks_ = patient();
    accepted_ = Descriptor();
    meet();
    EXPECT_EQ(chunks_.open(told(block_bytes, blocks), never_).code(),
              absl::StatusCode::kDataLoss);
  }
}

TEST_F(SharedChunksTest, ServesTheNextStreamOnceItHasRested) {
  meet();
  const auto copies = [&] {
    std::array<std::byte, 12> positions{};
    ChunkColumns to{};
    to.positions = positions;
    return chunks_.copy(0, to, {}).ok();
  };
  for (int stream = 0; stream < 3; ++stream) {
    ASSERT_TRUE(hand_over(memory_.descriptor()));
    ASSERT_EQ(chunks_.open(told(), never_), absl::OkStatus());
    EXPECT_TRUE(copies());
    chunks_.rest();
    EXPECT_FALSE(chunks_.is_open() || copies());  // until a header tells of it
    EXPECT_TRUE(chunks_.rests());
    EXPECT_EQ(chunks_.begin(path_, never_), token_);  // nobody accepts another connection
    EXPECT_FALSE(chunks_.rests());
  }
  const SealedMemory other = *SealedMemory::make(kBlock * kBlocks);
  other.bytes()[0] = std::byte{7};
  ASSERT_TRUE(hand_over(other.descriptor()));
  ASSERT_EQ(chunks_.open(told(), never_), absl::OkStatus());
  std::array<std::byte, 12> positions{};
  ChunkColumns to{};
  to.positions = positions;
  ASSERT_TRUE(chunks_.copy(0, to, {}).ok());
  EXPECT_EQ(positions[0], std::byte{7});
}

TEST_F(SharedChunksTest, ConnectsAnewAfterAStreamThatFailedOrAServerThatLeft) {
  meet();
  accepted_ = Descriptor();
  meet();  // which did not rest
  chunks_.rest();
  accepted_ = Descriptor();
  meet();
  chunks_.rest();
  EXPECT_EQ(chunks_.begin("", never_), "");  // another server
}

TEST_F(SharedChunksTest, HoldsNothingBetweenStreamsThatNobodyElseCanFree) {
  const SealedMemory freed = *SealedMemory::make(kBlock * kBlocks, Readers::kOtherUser);
  for (const SealedMemory* memory : std::array<const SealedMemory*, 2>{&memory_, &freed}) {
    chunks_ = patient();
    accepted_ = Descriptor();
    meet();
    ASSERT_TRUE(hand_over(memory->descriptor()));
    ASSERT_EQ(chunks_.open(told(), never_), absl::OkStatus());
    EXPECT_TRUE(chunks_.holds_memory());
    chunks_.rest();
    EXPECT_EQ(chunks_.holds_memory(), memory == &freed);
  }
}

TEST_F(SharedChunksTest, AChunkThatWasFreedIsAskedForAgain) {
  const SealedMemory memory = *SealedMemory::make(kBlock * kBlocks, Readers::kOtherUser);
  std::ranges::fill(memory.bytes(), std::byte{5});
  meet();
  MeshReceiver receiver;
  receiver.use_shared(chunks_, never_);
  v1::MeshEvent event;
  v1::MeshHeader& header = *event.mutable_header();
  header.set_mesh_id("m");
  header.set_vertex_count(3);
  header.set_chunk_count(1);
  header.set_coordinate_type(v1::COORDINATE_TYPE_FLOAT32);
  header.set_index_type(v1::INDEX_TYPE_UINT32);
  *header.mutable_shared_memory() = told();
  ASSERT_TRUE(hand_over(memory.descriptor()));
  ASSERT_EQ(receiver.take(event), absl::OkStatus());
  const std::uint32_t made = add_to_checksum(0, memory.bytes().first(36));
  memory.give_up();
  v1::MeshChunk& chunk = *event.mutable_chunk();
  chunk.set_vertex_count(3);
  chunk.set_shared_offset(0);
  chunk.set_checksum(made);
  EXPECT_EQ(receiver.take(event).code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(receiver.next_chunk(), 0U);
  EXPECT_EQ(chunks_.begin(path_, never_), "");  // as a message
}

TEST_F(SharedChunksTest, WhatItDistrustsItAsksForNoMore) {
  meet();
  EXPECT_EQ(chunks_.distrust(3).code(), absl::StatusCode::kUnavailable);
  chunks_.rest();
  EXPECT_FALSE(chunks_.rests());
  EXPECT_EQ(chunks_.begin(path_, never_), "");
}

TEST_F(SharedChunksTest, TakesEventsUntilTheNextIsInTheStream) {
  open_for_events(2);
  ASSERT_TRUE(say("one") && say("two") && say(std::string(1, '\0')) && say("three"));
  EXPECT_TRUE(takes("one"));
  EXPECT_TRUE(takes("two"));
  EXPECT_FALSE(takes(""));
  EXPECT_FALSE(takes(""));
  chunks_.acknowledge(0);  // the one that came in the stream
  EXPECT_TRUE(takes("three"));
}

TEST_F(SharedChunksTest, LooksIntoTheStreamWhileNothingComes) {
  open_for_events(2);
  grpc::ByteBuffer event;
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_FALSE(chunks_.take_event(event, cancelled, [] { return false; }));
  const auto in_stream = [] { return true; };
  ASSERT_TRUE(say("last"));
  EXPECT_TRUE(chunks_.take_event(event, never_, in_stream));
  EXPECT_FALSE(chunks_.take_event(event, never_, in_stream));
  chunks_.acknowledge(0);
  EXPECT_FALSE(takes(""));  // the rest is there, too
}

TEST_F(SharedChunksTest, LooksIntoTheStreamOnceTheServersEndIsGone) {
  open_for_events(2);
  ASSERT_TRUE(say("last"));
  accepted_ = Descriptor();
  EXPECT_TRUE(takes("last"));
  EXPECT_FALSE(takes(""));
  chunks_.acknowledge(1);
  EXPECT_FALSE(takes(""));
}

TEST_F(SharedChunksTest, TakesNoEventThatIsTooLong) {
  open_for_events(2);
  ASSERT_TRUE(say(std::string(kMostSideEventBytes, 'x')) &&
              say(std::string(kMostSideEventBytes + 1, 'x')) && say("after"));
  EXPECT_TRUE(takes(std::string(kMostSideEventBytes, 'x')));
  EXPECT_FALSE(takes(""));
  chunks_.acknowledge(0);
  EXPECT_FALSE(takes(""));
}

TEST_F(SharedChunksTest, AnswersForSeveralChunksAtOnce) {
  open_for_events(7);
  SideMessage said{};
  for (std::uint64_t chunk = 0; chunk < 5; ++chunk) {
    chunks_.acknowledge(chunk);
    const bool answers = chunk % 2 == 1;
    EXPECT_EQ(take_packet(accepted_, said), answers ? Packet::kTaken : Packet::kNone) << chunk;
    if (answers) {
      EXPECT_EQ(side_number(said), chunk);
    }
  }
  ASSERT_TRUE(say(std::string(1, '\0')));
  EXPECT_FALSE(takes(""));
  EXPECT_EQ(take_packet(accepted_, said), Packet::kTaken);
  EXPECT_EQ(side_number(said), 4U);
}

TEST_F(SharedChunksTest, AnswersInTimeWhereChunksAreSlowToCome) {
  chunks_ = patient(std::chrono::milliseconds(1));
  open_for_events(7);
  ASSERT_TRUE(say("one") && takes("one"));
  chunks_.acknowledge(0);  // and nothing comes
  SideMessage said{};
  bool answered = false;
  grpc::ByteBuffer event;
  // A look may come before the answer where a thread stands still, but none after it misses it.
  int looks = 0;
  EXPECT_FALSE(chunks_.take_event(event, never_, [&] {
    answered = take_packet(accepted_, said) == Packet::kTaken;
    return answered || ++looks == 3;  // ends the wait
  }));
  EXPECT_TRUE(answered);  // before the wait ended
}

TEST_F(SharedChunksTest, AnswersEachChunkThatTakesItsTime) {
  chunks_ = patient(std::chrono::milliseconds(0));
  open_for_events(7);
  SideMessage said{};
  for (std::uint64_t chunk = 0; chunk < 3; ++chunk) {
    chunks_.acknowledge(chunk);
    EXPECT_EQ(take_packet(accepted_, said), Packet::kTaken);
    EXPECT_EQ(side_number(said), chunk);
  }
}

TEST_F(SharedChunksTest, AWrongChunkThatNobodyCanHaveFreedIsNotAskedForAgain) {
  meet();
  ASSERT_TRUE(hand_over(memory_.descriptor()));
  ASSERT_EQ(chunks_.open(told(), never_), absl::OkStatus());
  EXPECT_EQ(chunks_.distrust(3).code(), absl::StatusCode::kDataLoss);
}

TEST_F(SharedChunksTest, IsNotToldOfWhatNobodyAskedFor) {
  EXPECT_EQ(chunks_.open(told(), never_).code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(chunks_.begin("", never_), "");
  EXPECT_EQ(chunks_.begin(folder_.file("nothing"), never_), "");
}

TEST_F(SharedChunksTest, WaitsForNoTokenOnceItIsCancelled) {
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_EQ(chunks_.begin(path_, cancelled), "");  // nobody answers at `listener_`
}

}  // namespace
}  // namespace tet
