#include "client/python/extension/stream.h"

#include "client/python/extension/arrays.h"

namespace tetstream::python {
namespace {

/// Keeps two threads out of one stream.
class Turn {
 public:
  explicit Turn(std::atomic<bool>& busy) : busy_(busy) {
    if (busy_.exchange(true)) {
      raise_error(
          {StatusCode::kFailedPrecondition, "another thread is in this stream: take turns"});
    }
  }
  ~Turn() { busy_ = false; }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  std::atomic<bool>& busy_;
};

py::object copy_of(const Chunk& chunk, const MeshHeader& header) {
  const ArrayMaker copies;
  return py::make_tuple(
      chunk.index, chunk.first_vertex, chunk.first_tet, copies.points(chunk.columns),
      copies.tets(chunk.columns), copies.regions(chunk.columns, header),
      copies.field_rows(chunk.columns, header), copies.faces(chunk.columns, header),
      copies.face_tets(chunk.columns, header), copies.face_labels(chunk.columns, header),
      copies.labels(chunk.columns, header));
}

}  // namespace

Stream::~Stream() { end(); }

void Stream::begin() {
  header_ = value_of(watch_.call([&] { return stream_->header(); }));
}

void Stream::check_open() const {
  if (closed_) raise_error({StatusCode::kCancelled, "the stream is closed"});
}

py::object Stream::next() {
  check_open();
  const Turn turn(busy_);
  const Chunk* const chunk = watch_.call([&] { return stream_->next(); });
  if (chunk != nullptr) return copy_of(*chunk, *header_);
  value_of(stream_->finish());
  watch_.finish();
  return py::none();
}

py::dict Stream::statistics() {
  check_open();
  const Turn turn(busy_);
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
  stream_.reset();
}

void bind_stream(py::module_& module) {
  py::class_<Stream>(module, "Stream")
      .def_property_readonly("header",
                             [](const Stream& stream) { return to_python(stream.header()); })
      .def("next", &Stream::next)
      .def("statistics", &Stream::statistics)
      .def("close", &Stream::close);
}

}  // namespace tetstream::python
