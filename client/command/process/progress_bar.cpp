#include "client/command/process/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <unistd.h>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/printable.h"

namespace tet {
namespace {

constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;
constexpr const char* kEraseLine = "\r\x1b[K";

bool stderr_is_a_terminal() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal && std::string_view(terminal) != "dumb";
}

/// 1234567 as "1.2M".
std::string short_number(double number) {
  for (const char* suffix : {"", "k", "M"}) {
    if (number < 1000) return absl::StrFormat("%.3g%s", number, suffix);
    number /= 1000;
  }
  return absl::StrFormat("%.3gG", number);
}

std::string minutes_and_seconds(double seconds) {
  const auto whole = static_cast<int>(std::min(std::ceil(seconds), 359999.0));
  return absl::StrFormat("%d:%02d", whole / 60, whole % 60);
}

}  // namespace

std::string progress_line(const std::string& stage,
                          const std::string& unit,
                          double done,
                          double total,
                          double seconds) {
  const double share = done / total;
  if (!(total > 0) || std::isnan(share)) return absl::StrCat(stage, " ...");
  const double fraction = std::clamp(share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(fraction * kBarWidth);
  std::string line =
      absl::StrFormat("%-9s [%s%s] %3d%%", stage, std::string(filled, '#'),
                      std::string(kBarWidth - filled, '.'), static_cast<int>(fraction * 100));
  if (seconds < 0.2 || done <= 0) return line;  // too early to tell how fast
  if (!unit.empty())
    absl::StrAppend(&line, "  ", short_number(done / seconds), " ", unit, "/s");
  const double left = seconds * (1 - fraction) / fraction;
  return absl::StrCat(line, "  ", minutes_and_seconds(left), " left");
}

ProgressBar::ProgressBar() : visible_(stderr_is_a_terminal()) {}

ProgressBar::~ProgressBar() { erase(); }

void ProgressBar::begin(const std::string& stage, const std::string& unit) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  unit_ = unit;
  stage_start_ = Clock::now();
  draw(0, 0);
}

void ProgressBar::update(double done, double total) {
  if (!visible_) return;
  // A thread that comes while another draws has nothing newer to say.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && Clock::now() - last_drawn_ >= kRedrawInterval) draw(done, total);
}

void ProgressBar::say(const std::string& line, std::FILE* to) {
  const std::lock_guard lock(mutex_);
  erase();
  std::fprintf(to, "%s\n", for_terminal(line).c_str());
  std::fflush(to);
}

void ProgressBar::say_lines(const std::string& text, std::FILE* to) {
  const std::lock_guard lock(mutex_);
  erase();
  std::fprintf(to, "%s\n", lines_for_terminal(text).c_str());
  std::fflush(to);
}

void ProgressBar::draw(double done, double total) {
  if (!visible_) return;
  last_drawn_ = Clock::now();
  const double seconds = std::chrono::duration<double>(last_drawn_ - stage_start_).count();
  const std::string line = for_terminal(progress_line(stage_, unit_, done, total, seconds));
  std::fprintf(stderr, "%s%s", kEraseLine, line.c_str());
}

void ProgressBar::erase() {
  if (visible_) std::fputs(kEraseLine, stderr);
}

}  // namespace tet
