// The module tetstream._tetstream: the C++ library, as thinly as it goes. What users see of it
// is written in Python, in ../tetstream.
#include "client/python/extension/bindings.h"
#include "client/python/extension/helper.h"
#include "tetstream/version.h"

namespace {

void note_fork() {
  tetstream::python::Helper::note_fork();
  tetstream::python::become_main_thread();
}

}  // namespace

PYBIND11_MODULE(_tetstream, module) {
  using namespace tetstream::python;
  find_main_thread();
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") =
                                                         py::cpp_function(&note_fork));
  module.def("version", [] { return tetstream::version(); });
  bind_volume(module);
  bind_labels(module);
  bind_request(module);
  bind_mesh(module);
  bind_stream(module);
  bind_mesher(module);
  bind_client(module);
  bind_samples(module);
  bind_session(module);
  bind_jobs(module);
}
