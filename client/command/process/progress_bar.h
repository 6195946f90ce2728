// One line on a terminal that says what is going on, how fast, and how long it will take.
#pragma once

#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>

namespace tet {

/// Draws on stderr when that is a terminal, and nothing otherwise.
///
/// Thread safety: any thread may call any member.
class ProgressBar {
 public:
  ProgressBar();
  /// Erases the line.
  ~ProgressBar();

  /// `unit` is what `update` counts, e.g. "tets"; empty when only the fraction means something.
  void begin(const std::string& stage, const std::string& unit = "");

  /// A total of 0 is not known yet.
  void update(double done, double total);

  /// A line for the reader that stays, terminal or not; the bar goes on below it. It may hold
  /// names and messages of others.
  void say(const std::string& line, std::FILE* to = stderr);
  /// Says several lines; whatever may hold a line's end of its own, say it `for_terminal`.
  void say_lines(const std::string& text, std::FILE* to);

 private:
  using Clock = std::chrono::steady_clock;

  void draw(double done, double total);
  void erase();

  const bool visible_;
  std::mutex mutex_;
  std::string stage_, unit_;
  Clock::time_point stage_start_, last_drawn_;
};

/// The line for one moment of a stage: "meshing  [#####.....]  50%  1.2M tets/s  0:07 left".
std::string progress_line(const std::string& stage,
                          const std::string& unit,
                          double done,
                          double total,
                          double seconds);

}  // namespace tet
