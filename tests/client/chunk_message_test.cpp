#include "client/library/chunk_message.h"

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/mesh_receiver.h"
#include "proto/wire/checksum.h"

namespace tet::test {
namespace {

/// A message as it may come from the network: in slices of so many bytes.
grpc::ByteBuffer in_slices(std::string_view bytes, std::size_t slice_bytes) {
  std::vector<grpc::Slice> slices;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(slice_bytes, bytes.size()))) {
    slices.emplace_back(std::string(bytes.substr(0, slice_bytes)));
  }
  return {slices.data(), slices.size()};
}

/// A mesh of both sides, three vertices with a value each and two tets, in one chunk.
v1::MeshEvent header() {
  v1::MeshEvent event;
  v1::MeshHeader& mesh = *event.mutable_header();
  mesh.set_mesh_id("m");
  mesh.set_vertex_count(3);
  mesh.set_tet_count(2);
  mesh.set_chunk_count(1);
  mesh.set_coordinate_type(v1::COORDINATE_TYPE_FLOAT32);
  mesh.set_index_type(v1::INDEX_TYPE_UINT32);
  mesh.set_has_regions(true);
  v1::FieldArray& field = *mesh.add_fields();
  field.set_name("heat");
  field.set_components(1);
  return event;
}

std::string ids(const std::vector<std::uint32_t>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()),
          numbers.size() * sizeof(std::uint32_t)};
}

v1::MeshEvent chunk() {
  v1::MeshEvent event;
  v1::MeshChunk& message = *event.mutable_chunk();
  message.set_vertex_count(3);
  message.set_tet_count(2);
  message.set_positions("positions: 3 times 3 times 4 bytes..");
  message.set_tets(ids({0, 1, 2, 0, 2, 1, 0, 1}));
  message.set_regions("\1\2");
  message.set_fields("three values");
  message.set_checksum(chunk_checksum(
      {message.positions(), message.tets(), message.regions(), message.fields()}));
  return event;
}

/// Ends the stream, so that there is nothing left to measure.
v1::MeshEvent trailer() {
  v1::MeshEvent event;
  event.mutable_trailer()->set_end_chunk(1);
  for (int i = 0; i < QualityStats::kBins; ++i) {
    event.mutable_trailer()->mutable_quality()->add_dihedral_histogram(0);
  }
  return event;
}

std::string text(const ByteBuffer& column) {
  return {reinterpret_cast<const char*>(column.bytes().data()), column.size()};
}

/// What becomes of bytes that come as the second message of a stream.
struct Outcome {
  absl::StatusCode code = absl::StatusCode::kOk;
  std::uint64_t chunks = 0;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome taken_by_hand(std::string_view bytes, std::size_t slice_bytes) {
  MeshReceiver receiver;
  EXPECT_TRUE(receiver.take(header()).ok());
  grpc::ByteBuffer message = in_slices(bytes, slice_bytes);
  const absl::Status status = receiver.take(message);
  return {status.code(), receiver.next_chunk()};
}

Outcome taken_by_protobuf(std::string_view bytes) {
  v1::MeshEvent event;
  if (!event.ParseFromString(std::string(bytes))) return {absl::StatusCode::kDataLoss, 0};
  MeshReceiver receiver;
  EXPECT_TRUE(receiver.take(header()).ok());
  const absl::Status status = receiver.take(event);
  return {status.code(), receiver.next_chunk()};
}

void expect_same_outcome(const std::string& bytes, const std::string& what) {
  const Outcome expected = taken_by_protobuf(bytes);
  for (const std::size_t slice_bytes : {std::size_t{1}, std::size_t{7}, bytes.size() + 1}) {
    EXPECT_TRUE(taken_by_hand(bytes, slice_bytes) == expected)
        << what << ", in slices of " << slice_bytes << " bytes";
  }
}

TEST(ReceivedChunk, PutsColumnsWhereTheyBelongHoweverTheyWereSliced) {
  const std::string bytes = chunk().SerializeAsString();
  for (std::size_t slice_bytes = 1; slice_bytes <= bytes.size(); ++slice_bytes) {
    grpc::ByteBuffer message = in_slices(bytes, slice_bytes);
    ASSERT_TRUE(read_chunk(message)) << "this is no test of protobuf's way";
    MeshReceiver receiver;
    ASSERT_TRUE(receiver.take(header()).ok());
    ASSERT_TRUE(receiver.take(message).ok()) << slice_bytes;
    ASSERT_TRUE(receiver.take(trailer()).ok());
    const auto finished = std::move(receiver).finish(Cancellation());
    ASSERT_TRUE(finished.ok()) << finished.status();
    const StreamedMesh& received = *finished;
    EXPECT_EQ(text(received.mesh.positions), chunk().chunk().positions());
    EXPECT_EQ(text(received.mesh.tets), chunk().chunk().tets());
    EXPECT_EQ(text(received.mesh.regions), chunk().chunk().regions());
    EXPECT_EQ(text(received.mesh.fields), chunk().chunk().fields());
  }
}

TEST(ReceivedChunk, RefusesWhatWasCutOffAnywhere) {
  const std::string whole = chunk().SerializeAsString();
  for (std::size_t size = 1; size < whole.size(); ++size) {
    EXPECT_EQ(taken_by_hand(whole.substr(0, size), 16).code, absl::StatusCode::kDataLoss)
        << size;
    expect_same_outcome(whole.substr(0, size), "cut after " + std::to_string(size));
  }
}

TEST(ReceivedChunk, RefusesEveryByteThatWasChangedAsProtobufWould) {
  const std::string whole = chunk().SerializeAsString();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const int change : {0x01, 0x07, 0x80, 0xff}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ change);
      expect_same_outcome(changed, "byte " + std::to_string(i));
    }
  }
}

TEST(ReceivedChunk, TakesRandomFieldsAsProtobufWould) {
  std::mt19937 random(7);
  const std::string pieces[] = {std::string("\x1a\x02\x08\x01", 4),
                                std::string("\x3a\x00", 2),
                                std::string("\x3a\xff\xff\xff\xff\x0f", 6),
                                std::string("\x08\x80\x80\x80\x80\x80\x80\x80\x80\x80\x01", 11),
                                std::string("\x10\xff\xff\xff\xff\xff\xff\xff\xff\xff\x7f", 11),
                                std::string("\x35"
                                            "abcd",
                                            5),
                                std::string("\x42\x01x", 3),
                                std::string("\x4a\x02\x01\x02", 4),
                                std::string("\x7a\x01z", 3),
                                std::string("\x18\x03\x28\x02", 4),
                                std::string("\x00", 1),
                                std::string("\x0b\x0c", 2)};
  for (int trial = 0; trial < 3000; ++trial) {
    std::string fields;
    for (auto count = random() % 6; count > 0; --count)
      fields += pieces[random() % std::size(pieces)];
    if (random() % 2 == 0) fields += chunk().chunk().SerializeAsString();
    std::string message = "\x1a";
    message += static_cast<char>(std::min<std::size_t>(fields.size() + random() % 3 / 2, 127));
    message += fields;
    if (random() % 8 == 0) message += pieces[random() % std::size(pieces)];
    expect_same_outcome(message, "trial " + std::to_string(trial));
  }
}

TEST(ReceivedChunk, TakesFieldsInAnotherOrderByProtobufsHelp) {
  const v1::MeshChunk whole = chunk().chunk();
  v1::MeshChunk columns;
  columns.set_positions(whole.positions());
  columns.set_tets(whole.tets());
  columns.set_regions(whole.regions());
  v1::MeshChunk numbers = whole;
  numbers.clear_positions();
  numbers.clear_tets();
  numbers.clear_regions();
  const std::string fields = columns.SerializeAsString() + numbers.SerializeAsString();
  const std::string message =
      "\x1a" + std::string(1, static_cast<char>(fields.size())) + fields;
  ASSERT_LT(fields.size(), 128U);
  EXPECT_EQ(taken_by_hand(message, 16), (Outcome{absl::StatusCode::kOk, 1}));
}

TEST(ReceivedChunk, RefusesVerticesThatThereAreNot) {
  v1::MeshEvent beyond = chunk();
  v1::MeshChunk& message = *beyond.mutable_chunk();
  message.set_tets(ids({0, 1, 2, 0, 2, 1, 0, 3}));
  message.set_checksum(chunk_checksum(
      {message.positions(), message.tets(), message.regions(), message.fields()}));
  const Outcome refused{absl::StatusCode::kDataLoss, 0};
  EXPECT_EQ(taken_by_hand(beyond.SerializeAsString(), 16), refused);
  EXPECT_EQ(taken_by_protobuf(beyond.SerializeAsString()), refused);
}

TEST(ReceivedChunk, RefusesAPackedChunkThatCannotBeUnpacked) {
  v1::MeshEvent event = chunk();
  v1::MeshChunk& message = *event.mutable_chunk();
  message.clear_positions();
  message.clear_tets();
  message.set_packed(std::string(100, '\x7f'));
  const Outcome refused{absl::StatusCode::kDataLoss, 0};
  EXPECT_EQ(taken_by_hand(event.SerializeAsString(), 16), refused) << "of a wrong checksum";
  message.set_checksum(chunk_checksum({message.packed()}));
  EXPECT_EQ(taken_by_hand(event.SerializeAsString(), 16), refused);
  EXPECT_EQ(taken_by_protobuf(event.SerializeAsString()), refused);
}

TEST(ReceivedChunk, RefusesAColumnLongerThanTheMessage) {
  // positions of 2^31 - 1 bytes, of which none came
  grpc::ByteBuffer message = in_slices("\x1a\x06\x3a\xff\xff\xff\xff\x07", 3);
  EXPECT_FALSE(read_chunk(message));
}

TEST(ReceivedChunk, RefusesAnEmptyMessageWithoutAChunk) {
  grpc::ByteBuffer nothing;
  EXPECT_FALSE(read_chunk(nothing));
  grpc::ByteBuffer empty = in_slices("", 1);
  EXPECT_FALSE(read_chunk(empty));
}

}  // namespace
}  // namespace tet::test
