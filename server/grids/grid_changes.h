// What the servers of one store tell each other of its grids: a journal in the store itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/posix/file.h"
#include "server/grids/stored_grids.h"

namespace tet {

struct GridChange {
  enum class Kind {
    kStored,  ///< a whole file came
    kGone,    ///< a whole file went
    kBegun,   ///< an upload is under way, which needs room for all of `size_bytes`
    kPaused,  ///< an upload waits to be resumed with `size_bytes`; 0: it is gone
  };
  Kind kind = Kind::kStored;
  GridKey key;
  std::uint64_t size_bytes = 0;
  std::string sender = {};  ///< of kBegun: who sends the file
};

/// The file `grids.changes` of a store, and how much of it this process has read. Whoever adds
/// grids, removes them, begins or ends uploads has the file's lock meanwhile, and writes a line
/// of text for each. What is in the folders is what holds: a line that is lost, or a journal
/// that begins anew, only means that they are to be looked at once more.
///
/// Not thread-safe.
class GridChanges {
 public:
  explicit GridChanges(const std::filesystem::path& store) : path_(store / "grids.changes") {}

  /// The file, locked: a turn, which ends when the file is closed. Errors: those of
  /// lock_patiently.
  absl::StatusOr<File> take_turn() const;
  /// Takes the turn if it can be had at once.
  absl::StatusOr<std::optional<File>> try_turn() const;

  /// What others have told since this process read last. Returns nothing where that is not
  /// known.
  std::optional<std::vector<GridChange>> news(const File& turn);
  /// All that the journal still has of uploads, oldest first; `news` goes on from its end.
  std::vector<GridChange> read_anew(File& turn);

  /// Adds a line. A disk that takes none makes all processes look at the folders again.
  void tell(File& turn, const GridChange& change);
  /// Whether the journal is so long that it had better begin anew.
  bool is_long() const { return end_ > kLongBytes; }
  /// Begins it anew with these lines: the others will look at the folders.
  void begin_anew(File& turn, const std::vector<GridChange>& changes);

 private:
  static constexpr std::uint64_t kLongBytes = std::uint64_t{4} << 20;

  void write(File& turn, const std::string& text);

  const std::filesystem::path path_;
  std::string name_;       ///< of the journal that was read; empty: of none
  std::uint64_t end_ = 0;  ///< of what was read
};

}  // namespace tet
