#include "tetstream/session.h"

#include <memory>
#include <optional>

#include "client/python/extension/bindings.h"
#include "tetstream/client.h"

namespace tetstream::python {
namespace {

/// A session, watched for as long as it lives. One thread at a time may be in it, which Python
/// sees to.
class HeldSession {
 public:
  template <class Function>
  HeldSession(const CallOptions& options, const Function& begin) : watch_(options.watch()) {
    const StreamOptions work = options.connected(watch_);
    session_ = value_of(watch_.call([&] { return begin(work); }));
  }
  ~HeldSession() {
    watch_.stop();
    const py::gil_scoped_release released;
    session_.reset();
  }
  HeldSession(const HeldSession&) = delete;
  HeldSession& operator=(const HeldSession&) = delete;

  Mesh mesh() const { return session_->mesh(); }
  std::uint64_t tets_sent() const { return session_->tets_sent(); }
  bool is_over() const { return session_->is_over(); }

  template <class Solid>
  void update(const Solid& solid) {
    const Status status = watch_.call([&] { return session_->update(solid); });
    if (!status.ok()) raise_error(status);
  }

  /// Any thread may call it.
  void stop() const { watch_.stop(); }

  void end() {
    const Status status = watch_.call([&] { return session_->end(); });
    if (!status.ok()) raise_error(status);
  }

 private:
  Watch watch_;
  std::optional<Session> session_;
};

template <class Solid>
std::unique_ptr<HeldSession> session_here(const Solid& solid,
                                          const Request& request,
                                          const CallOptions& options) {
  return std::make_unique<HeldSession>(
      options, [&](const WorkOptions& work) { return begin_session(solid, request, work); });
}

template <class Solid>
std::unique_ptr<HeldSession> session_there(const Client& client,
                                           const Solid& solid,
                                           const Request& request,
                                           const CallOptions& options) {
  return std::make_unique<HeldSession>(options, [&](const WorkOptions& work) {
    return client.begin_session(solid, request, work);
  });
}

}  // namespace

void bind_session(py::module_& module) {
  py::class_<HeldSession>(module, "Session")
      .def_property_readonly("mesh", &HeldSession::mesh)
      .def_property_readonly("tets_sent", &HeldSession::tets_sent)
      .def_property_readonly("is_over", &HeldSession::is_over)
      .def("update", &HeldSession::update<Volume>)
      .def("update", &HeldSession::update<Scene>)
      .def("end", &HeldSession::end)
      .def("stop", &HeldSession::stop);
  module.def("session", &session_here<Volume>);
  module.def("session", &session_here<Scene>);
  module.def("session_there", &session_there<Volume>);
  module.def("session_there", &session_there<Scene>);
}

}  // namespace tetstream::python
