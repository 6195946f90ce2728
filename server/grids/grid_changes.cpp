#include "server/grids/grid_changes.h"

#include <algorithm>
#include <random>
#include <string_view>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>

#include "proto/wire/sha256.h"
#include "server/ops/disk.h"
#include "server/ops/patient_lock.h"

namespace tet {

namespace {

// The first line: what this is, the version of the lines, and a random name.
constexpr std::string_view kTitle = "tetstream grids 1 ";
constexpr std::size_t kNameDigits = 16;
constexpr std::size_t kHeadBytes = kTitle.size() + kNameDigits + 1;

constexpr std::string_view kLetters = "+-><";  ///< in the order of GridChange::Kind

std::string new_name() {
  std::random_device random;
  return absl::StrFormat("%08x%08x", random(), random());
}

std::string line_of(const GridChange& change) {
  return absl::StrCat(std::string(1, kLetters[static_cast<std::size_t>(change.kind)]), " ",
                      change.key.space, " ", change.key.digest, " ", change.size_bytes, " ",
                      absl::BytesToHexString(change.sender), "\n");
}

std::optional<GridChange> change_of(std::string_view line) {
  const std::vector<std::string> words =
      absl::StrSplit(absl::string_view(line.data(), line.size()), ' ');
  if (words.size() != 5 || words[0].size() != 1) return std::nullopt;
  const std::size_t kind = kLetters.find(words[0]);
  GridChange change;
  if (kind == kLetters.npos || words[1].empty() || !is_sha256_hex(words[2]) ||
      !absl::SimpleAtoi(words[3], &change.size_bytes) || words[4].size() % 2 != 0 ||
      !std::ranges::all_of(words[4], absl::ascii_isxdigit)) {
    return std::nullopt;
  }
  change.kind = static_cast<GridChange::Kind>(kind);
  change.key = {words[1], words[2]};
  change.sender = absl::HexStringToBytes(words[4]);
  return change;
}

std::string text_from(const File& file, std::uint64_t begin) {
  const auto size = file.size();
  if (!size.ok() || *size <= begin) return "";
  std::string text(*size - begin, '\0');
  const auto read = file.read_at(begin, text);
  text.resize(read.ok() ? *read : 0);
  return text;
}

/// The random name; empty where the file has no such line.
std::string name_in(const File& file) {
  std::string head(kHeadBytes, '\0');
  const auto read = file.read_at(0, head);
  const bool is_whole = read.ok() && *read == kHeadBytes && head.back() == '\n';
  if (!is_whole || head.substr(0, kTitle.size()) != kTitle) return "";
  return head.substr(kTitle.size(), kNameDigits);
}

/// Whole lines, and how many bytes they have. Whoever died over a line left a part of it, which
/// the next line takes the place of. Returns nothing if one of them says nothing.
std::optional<std::pair<std::vector<GridChange>, std::uint64_t>> changes_in(
    std::string_view text) {
  std::vector<GridChange> changes;
  std::uint64_t end = 0;
  while (true) {
    const std::size_t stop = text.find('\n', end);
    if (stop == text.npos) return std::pair(std::move(changes), end);
    auto change = change_of(text.substr(end, stop - end));
    if (!change) return std::nullopt;
    changes.push_back(*std::move(change));
    end = stop + 1;
  }
}

}  // namespace

absl::StatusOr<File> GridChanges::take_turn() const {
  auto file = open_file(path_, O_RDWR | O_CREAT);
  if (!file.ok()) return file.status();
  if (auto locked = lock_patiently(*file, "the journal of grids"); !locked.ok()) return locked;
  return file;
}

absl::StatusOr<std::optional<File>> GridChanges::try_turn() const {
  auto file = open_file(path_, O_RDWR | O_CREAT);
  if (!file.ok()) return file.status();
  const auto locked = file->lock(FileLock::kAlone);
  if (!locked.ok()) return locked.status();
  return *locked ? std::optional<File>(*std::move(file)) : std::nullopt;
}

std::optional<std::vector<GridChange>> GridChanges::news(const File& turn) {
  if (name_.empty() || name_in(turn) != name_) return std::nullopt;
  auto found = changes_in(text_from(turn, end_));
  if (!found) return std::nullopt;
  end_ += found->second;
  return std::move(found->first);
}

std::vector<GridChange> GridChanges::read_anew(File& turn) {
  name_ = name_in(turn);
  auto found = changes_in(text_from(turn, kHeadBytes));
  if (name_.empty() || !found) {
    begin_anew(turn, {});
    return {};
  }
  end_ = kHeadBytes + found->second;
  std::erase_if(found->first, [](const GridChange& change) {
    return change.kind == GridChange::Kind::kStored || change.kind == GridChange::Kind::kGone;
  });
  return std::move(found->first);
}

void GridChanges::tell(File& turn, const GridChange& change) {
  if (!name_.empty()) write(turn, line_of(change));
}

void GridChanges::begin_anew(File& turn, const std::vector<GridChange>& changes) {
  name_ = new_name();
  end_ = 0;
  std::string text = absl::StrCat(std::string(kTitle), name_, "\n");
  for (const GridChange& change : changes) text += line_of(change);
  write(turn, text);
}

void GridChanges::write(File& turn, const std::string& text) {
  absl::Status written = turn.truncate(end_);
  if (written.ok()) written = turn.write_at(end_, text);
  end_ += text.size();
  if (written.ok()) return;
  turn.truncate(0).IgnoreError();
  name_.clear();
}

}  // namespace tet
