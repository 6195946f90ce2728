#include "core/stuffing/zero_brackets.h"

#include <numeric>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

using Columns = ZeroBrackets::Columns;

/// The i-th bracket, whether or not it is done.
ZeroBracket bracket_at(const Columns& columns, std::size_t i) noexcept {
  return {columns.x[i],   columns.f[i],     columns.other[i], columns.f_other[i],
          columns.old[i], columns.f_old[i], columns.next[i]};
}

/// Writes what a bracket knows: neither what it tries next, nor whether it is done.
void put(const ZeroBracket& bracket, Columns& columns, std::size_t i) noexcept {
  columns.x[i] = bracket.x;
  columns.f[i] = bracket.f;
  columns.other[i] = bracket.other;
  columns.f_other[i] = bracket.f_other;
  columns.old[i] = bracket.old;
  columns.f_old[i] = bracket.f_old;
}

TET_VECTOR_CLONES
void begin_all(const float* at_0,
               const float* at_1,
               std::size_t count,
               Columns& columns) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    ZeroBracket bracket;
    bracket.begin(static_cast<double>(at_0[i]), static_cast<double>(at_1[i]));
    put(bracket, columns, i);
    columns.next[i] = bracket.next;
  }
}

/// Returns how many are done.
TET_VECTOR_CLONES
std::uint64_t take_all(const double* phi, std::size_t count, Columns& columns) noexcept {
  std::uint64_t done = 0;
  for (std::size_t i = 0; i < count; ++i) {
    ZeroBracket bracket = bracket_at(columns, i);
    bracket.take(phi[i]);
    put(bracket, columns, i);
    columns.done[i] = bracket.done ? 1 : 0;
    done += columns.done[i];
  }
  return done;
}

TET_VECTOR_CLONES
void find_next_of_all(std::size_t count, Columns& columns) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    ZeroBracket bracket = bracket_at(columns, i);
    bracket.find_next();
    columns.next[i] = bracket.next;
  }
}

}  // namespace

void ZeroBrackets::begin(const float* at_0, const float* at_1, std::size_t count) noexcept {
  begin_all(at_0, at_1, count, columns_);
  std::iota(which_.begin(), which_.begin() + static_cast<std::ptrdiff_t>(count), 0);
  open_ = count;
}

void ZeroBrackets::narrow(const double* phi, float* zeros) noexcept {
  const std::uint64_t done = take_all(phi, open_, columns_);
  if (done == open_) return end(zeros);  // most are done after as many steps
  if (done > 0) close_done(zeros);
  find_next_of_all(open_, columns_);
}

void ZeroBrackets::close_done(float* zeros) noexcept {
  std::size_t still = 0;
  for (std::size_t i = 0; i < open_; ++i) {
    if (columns_.done[i] != 0) {
      zeros[which_[i]] = zero(i);
    } else {
      if (still != i) move(i, still);
      ++still;
    }
  }
  open_ = still;
}

void ZeroBrackets::end(float* zeros) noexcept {
  for (std::size_t i = 0; i < open_; ++i) zeros[which_[i]] = zero(i);
  open_ = 0;
}

float ZeroBrackets::zero(std::size_t i) const noexcept {
  return static_cast<float>(bracket_at(columns_, i).zero());
}

void ZeroBrackets::move(std::size_t from, std::size_t to) noexcept {
  for (Columns::Column* column : {&columns_.x, &columns_.f, &columns_.other, &columns_.f_other,
                                  &columns_.old, &columns_.f_old}) {
    (*column)[to] = (*column)[from];
  }
  which_[to] = which_[from];
}

}  // namespace tet
