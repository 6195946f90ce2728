#include "client/python/extension/stream.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "client/python/extension/arrays.h"
#include "client/python/extension/turn.h"

namespace tetstream::python {
namespace {

using Clock = std::chrono::steady_clock;
using Kept = std::shared_ptr<const void>;

/// To have a chunk from another thread takes some 30 microseconds: what comes within a few
/// times that is worth waiting for.
constexpr std::chrono::microseconds kSoon{500};
constexpr std::size_t kMostAhead = 4;

/// Gives the chunk to Python: its arrays are the only ones that keep its memory.
py::object handed_over(const Chunk& chunk, Kept memory, const MeshHeader& header) {
  const py::capsule owner(new Kept(std::move(memory)),
                          [](void* kept) { delete static_cast<Kept*>(kept); });
  const ArrayMaker arrays(owner, ArrayMaker::Owner::kAlone);
  return py::make_tuple(
      chunk.index, chunk.first_vertex, chunk.first_tet, arrays.points(chunk.columns, header),
      arrays.tets(chunk.columns, header), arrays.regions(chunk.columns, header),
      arrays.field_rows(chunk.columns, header), arrays.faces(chunk.columns, header),
      arrays.face_tets(chunk.columns, header), arrays.face_labels(chunk.columns, header),
      arrays.labels(chunk.columns, header));
}

}  // namespace

Stream::~Stream() { end(); }

void Stream::begin() {
  header_ = value_of(watch_.call([&] { return stream_->header(); }));
}

void Stream::check_open() const {
  if (closed_) raise_error({StatusCode::kCancelled, "the stream is closed"});
}

py::object Stream::next(bool alone) {
  check_open();
  const Turn turn(busy_, "stream");
  if (!has_come()) {
    read(alone ? 1 : ahead_);
    if (!has_come()) {
      value_of(stream_->finish());
      watch_.finish();
      return py::none();
    }
  }
  Came& next = came_[given_++];
  return handed_over(next.chunk, std::move(next.memory), *header_);
}

void Stream::read(std::size_t most) {
  came_.clear();
  given_ = 0;
  watch_.call([&] {
    bool soon = true;
    while (soon && came_.size() < most) {
      const Clock::time_point begin = Clock::now();
      const Chunk* const chunk = stream_->next();
      if (chunk == nullptr) break;
      came_.push_back({*chunk, stream_->keep_chunk()});
      soon = Clock::now() - begin < kSoon;
    }
    ahead_ = soon ? std::min(2 * ahead_, kMostAhead) : 1;
    return true;
  });
  watch_.tell_reached();
}

py::dict Stream::statistics() {
  check_open();
  const Turn turn(busy_, "stream");
  if (has_come()) {
    raise_error({StatusCode::kFailedPrecondition,
                 "there are chunks to come: read the stream to its end"});
  }
  return to_python(value_of(stream_->finish()));
}

void Stream::close() {
  closed_ = true;
  watch_.stop();  // a thread that is in `next` leaves it soon
  if (busy_.exchange(true)) return;
  end();
  busy_ = false;
}

void Stream::end() {
  watch_.stop();
  const py::gil_scoped_release released;
  came_.clear();
  stream_.reset();
}

void bind_stream(py::module_& module) {
  py::class_<Stream>(module, "Stream")
      .def_property_readonly("header",
                             [](const Stream& stream) { return to_python(stream.header()); })
      .def("next", &Stream::next, py::arg("alone") = false)
      .def("statistics", &Stream::statistics)
      .def("close", &Stream::close);
}

}  // namespace tetstream::python
