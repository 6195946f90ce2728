// No byte of a result depends on what lay in memory before: broken files are decoded twice, in
// memory filled with one value and with another, and without the walk that refuses most of
// them.
//
//   TETSTREAM_TRIALS=10000 build/release/bin/poison_test     for more than a few
#include <cstdlib>
#include <fcntl.h>
#include <map>
#include <random>
#include <string>
#include <sys/stat.h>

#include <gtest/gtest.h>

#include "core/vdb/decoder/decoder_supply.h"
#include "tests/core/vdb/decode_test_files.h"
#include "tests/support/eventually.h"

namespace tet {
namespace {

constexpr unsigned kSeed = 20'221'121;

int trials() {
  const char* const wanted = std::getenv("TETSTREAM_TRIALS");
  return wanted == nullptr ? 40 : std::atoi(wanted);
}

class PoisonTest : public test::DecodeTest {
 protected:
  /// The result's bytes, or why there are none.
  std::string decode(const std::string& poison) {
    DecoderSupply& supply =
        supplies_.try_emplace(poison, test::patient_program("", {"MALLOC_PERTURB_=" + poison}))
            .first->second;
    absl::StatusOr<Decoder> decoder = supply.take(nullptr);
    if (!decoder.ok() || !decoder->wait_until_ready(nullptr).ok()) return "not started";
    const Descriptor file(::open(path_.c_str(), O_RDONLY | O_CLOEXEC));
    DecodeOrder order;
    order.file_name = "mutant";
    order.file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path_));
    order.limits = {std::uint64_t{64} << 20, std::uint64_t{256} << 20, 2};
    const auto block = decoder->decode(order, file.number(), {test::kGenerousEnd, nullptr});
    if (!block.ok()) return "refused";
    const auto bytes = block->bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  void write(const std::string& bytes) { test::write_bytes(path_, bytes); }

 private:
  std::map<std::string, DecoderSupply> supplies_;  ///< by what memory is filled with
};

TEST_F(PoisonTest, LeavesNoTraceInTruncatedFiles) {
  const std::string whole = test::read_bytes(path_);
  for (std::size_t part = 1; part < 10; ++part) {
    write(whole.substr(0, whole.size() * part / 10));
    EXPECT_EQ(decode("85"), "refused") << part;
  }
}

TEST_F(PoisonTest, LeavesNoTraceInBrokenFiles) {
  const std::string whole = test::read_bytes(path_);
  std::mt19937 random(kSeed);
  std::printf("seed %u\n", kSeed);
  int accepted = 0;
  for (int trial = 0; trial < trials(); ++trial) {
    std::string mutant = whole;
    mutant[random() % mutant.size()] = static_cast<char>(random());
    write(mutant);
    const std::string first = decode("85"), second = decode("170");
    EXPECT_TRUE(first == second) << "trial " << trial;
    if (first.size() > 100) ++accepted;
  }
  EXPECT_GT(accepted, 0);  // else nothing was compared
  std::printf("%d of %d mutants were decoded\n", accepted, trials());
}

}  // namespace
}  // namespace tet
