// What a run looks like while it goes on.
#pragma once

#include <string>

#include "bench/load/run_load.h"

namespace tet::load {

/// One screen for one moment: a few lines without control characters. `previous` is the moment
/// before; rates are of the time in between.
std::string live_screen(const std::string& title,
                        const LoadMoment& previous,
                        const LoadMoment& moment);

/// Tells the moment in one line, for logs.
std::string live_line(const LoadMoment& previous, const LoadMoment& moment);

/// Draws on stderr: a screen that is redrawn in place when that is a terminal, else a line now
/// and then. Not thread-safe.
class LiveView {
 public:
  /// With `quiet` it draws nothing.
  LiveView(std::string title, bool quiet);
  /// Erases the screen; lines stay.
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  LoadWatch watch();

 private:
  void draw(const LoadMoment& moment);
  void erase();

  const std::string title_;
  const bool quiet_, terminal_;
  LoadMoment previous_;
  int lines_drawn_ = 0;
};

}  // namespace tet::load
