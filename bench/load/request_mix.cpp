#include "bench/load/request_mix.h"

#include <cmath>
#include <utility>

#include "bench/load/arrivals.h"

namespace tet::load {

std::uint64_t draw_fresh_from() { return std::random_device()() % (1u << 30); }

RequestMix::RequestMix(std::vector<MixEntry> entries) : entries_(std::move(entries)) {
  for (const MixEntry& entry : entries_) weight_ += entry.weight;
}

std::size_t RequestMix::draw_entry(std::mt19937_64& random) const {
  double place = uniform_number(random) * weight_;
  std::size_t entry = 0;
  while (entry + 1 < entries_.size() && place >= entries_[entry].weight) {
    place -= entries_[entry++].weight;
  }
  return entry;
}

RequestMix::Drawn RequestMix::draw(std::mt19937_64& random) {
  Drawn drawn{draw_entry(random), {}};
  const MixEntry& entry = entries_[drawn.entry];
  drawn.message = entry.message;
  if (entry.iso) {
    drawn.message.set_iso(std::lerp(entry.iso->low, entry.iso->high, uniform_number(random)));
  }
  if (entry.fresh) {
    // Some four units in the last place: products with any spacing stay apart.
    const double growth = 1e-15 * static_cast<double>(entry.fresh_from + ++drawn_);
    drawn.message.set_spacing(drawn.message.spacing() * (1 + growth));
  }
  return drawn;
}

}  // namespace tet::load
