#include "server/grids/verify.h"

#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/ops/disk.h"
#include "server/ops/guard.h"

namespace tet {

namespace {

constexpr std::size_t kVerifyReadBytes = std::size_t{1} << 20;
/// What is read in one turn: others' turns come every few hundredths of a second.
constexpr std::uint64_t kVerifiedBytesOfTurn = std::uint64_t{16} << 20;

absl::Status corrupt(const std::string& digest, std::string_view why) {
  return with_reason(absl::DataLossError(
                         absl::StrCat("the stored file of ", name_of_grid(digest), " ",
                                      std::string(why), "; it was set aside: upload it again")),
                     "STORED_GRID_CORRUPT");
}

/// One look at all of a stored file, as far as it has come.
class Verification {
 public:
  explicit Verification(const std::filesystem::path& path)
      : name_(path.filename().string()), file_(open_file(path, O_RDONLY)) {}

  /// Reads at most `most_bytes` more, looking at `cancelled` after every megabyte. Nothing as
  /// long as there is more to read.
  std::optional<absl::Status> go_on(std::uint64_t most_bytes,
                                    const std::function<bool()>& cancelled) {
    if (absl::IsNotFound(file_.status())) return corrupt(name_, "is gone");
    if (!file_.ok()) return file_.status();
    std::vector<char> buffer(kVerifyReadBytes);
    for (std::uint64_t end = offset_ + most_bytes; offset_ < end;) {
      if (cancelled()) return absl::CancelledError("nobody wants the grid any more");
      const auto count = file_->read_at(offset_, buffer);
      if (!count.ok()) return count.status();
      if (*count == 0) return judge(digest_.finish_hex());
      digest_.add(std::string_view(buffer.data(), *count));
      offset_ += *count;
    }
    return std::nullopt;
  }

 private:
  absl::Status judge(const std::string& found) const {
    if (found == name_) return absl::OkStatus();
    return corrupt(name_, absl::StrCat("has other bytes, with the SHA-256 ", found));
  }

  std::string name_;
  absl::StatusOr<File> file_;
  Sha256 digest_;
  std::uint64_t offset_ = 0;
};

/// What is left of a file that is verified in turns.
struct Rest {
  TurnsToVerify turns;
  Verification file;
  std::function<void(const absl::Status&)> done;
};

void post_turn(const std::shared_ptr<Rest>& rest) {
  rest->turns.disk.post(rest->turns.client, [rest] {
    const auto outcome = guarded("verifying a grid", [&]() -> absl::StatusOr<bool> {
      const auto end = rest->file.go_on(kVerifiedBytesOfTurn, rest->turns.cancelled);
      if (end && !end->ok()) return *end;
      if (!end) post_turn(rest);
      return end.has_value();
    });
    if (!outcome.ok() || *outcome) rest->done(outcome.status());
  });
}

}  // namespace

absl::Status verify_stored(const std::filesystem::path& path,
                           const std::function<bool()>& cancelled) {
  Verification file(path);
  std::optional<absl::Status> end;
  while (!end) end = file.go_on(kVerifiedBytesOfTurn, cancelled);
  return *end;
}

void verify_in_turns(TurnsToVerify turns,
                     const std::filesystem::path& path,
                     std::function<void(const absl::Status&)> done) {
  post_turn(
      std::make_shared<Rest>(Rest{std::move(turns), Verification(path), std::move(done)}));
}

}  // namespace tet
