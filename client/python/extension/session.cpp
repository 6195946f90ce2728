#include "tetstream/session.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/python/extension/arrays.h"
#include "client/python/extension/bindings.h"
#include "client/python/extension/turn.h"
#include "tetstream/client.h"
#include "tetstream/stable_session.h"

namespace tetstream::python {
namespace {

using BoxRows = py::array_t<std::int32_t, py::array::c_style>;

/// A session of either kind, watched for as long as it lives. One thread at a time may be in
/// it; what is told of it meanwhile is what was so before.
template <class Kind>
class HeldSession {
 public:
  template <class Function>
  HeldSession(const CallOptions& options, const Function& begin) : watch_(options.watch()) {
    const StreamOptions work = options.connected(watch_);
    session_ = value_of(watch_.call([&] { return begin(work); }));
    note();
  }
  ~HeldSession() {
    watch_.stop();
    const py::gil_scoped_release released;
    session_.reset();
  }
  HeldSession(const HeldSession&) = delete;
  HeldSession& operator=(const HeldSession&) = delete;

  auto mesh() {
    const Use use(*this);
    return session_->mesh();
  }
  std::uint64_t tets_sent() const { return tets_sent_; }
  bool is_over() const { return over_; }

  Mesh in_order() {
    const Use use(*this);
    return value_of(watch_.call([&] { return session_->in_order(); }));
  }

  template <class Solid>
  auto update(const Solid& solid) {
    return take_frame([&] { return session_->update(solid); });
  }

  /// `boxes` has a row of six for each: its begin, and its end.
  auto update_replaced(const Volume& volume, const BoxRows& boxes) {
    std::vector<SampleBox> replaced(static_cast<std::size_t>(boxes.shape(0)));
    const std::int32_t* row = boxes.data();
    for (SampleBox& box : replaced) {
      std::copy_n(row, 3, box.begin.begin());
      std::copy_n(row + 3, 3, box.end.begin());
      row += 6;
    }
    return take_frame([&] { return session_->update(volume, replaced); });
  }

  /// Any thread may call it.
  void stop() const { watch_.stop(); }

  void end() {
    const Use use(*this);
    const Status status = watch_.call([&] { return session_->end(); });
    if (!status.ok()) raise_error(status);
  }

 private:
  /// A thread's turn.
  class Use {
   public:
    explicit Use(HeldSession& held) : turn_(held.busy_, "session"), held_(held) {}
    ~Use() { held_.note(); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    const Turn turn_;
    HeldSession& held_;
  };

  /// Returns the mesh of the frame, before another thread may have the session.
  template <class Function>
  auto take_frame(const Function& frame) {
    const Use use(*this);
    const Status status = watch_.call(frame);
    if (!status.ok()) raise_error(status);
    return session_->mesh();
  }

  void note() {
    tets_sent_ = session_->tets_sent();
    over_ = session_->is_over();
  }

  Watch watch_;
  std::optional<Kind> session_;
  std::atomic<bool> busy_{false};  ///< a thread has its turn
  std::atomic<std::uint64_t> tets_sent_{0};
  std::atomic<bool> over_{false};
};

using HeldPlain = HeldSession<Session>;
using HeldStable = HeldSession<StableSession>;

template <class Solid>
std::unique_ptr<HeldPlain> session_here(const Solid& solid,
                                        const Request& request,
                                        const CallOptions& options) {
  return std::make_unique<HeldPlain>(
      options, [&](const WorkOptions& work) { return begin_session(solid, request, work); });
}

template <class Solid>
std::unique_ptr<HeldPlain> session_there(const Client& client,
                                         const Solid& solid,
                                         const Request& request,
                                         const CallOptions& options) {
  return std::make_unique<HeldPlain>(options, [&](const WorkOptions& work) {
    return client.begin_session(solid, request, work);
  });
}

template <class Solid>
std::unique_ptr<HeldStable> stable_session_here(const Solid& solid,
                                                const Request& request,
                                                const CallOptions& options) {
  return std::make_unique<HeldStable>(options, [&](const WorkOptions& work) {
    return begin_stable_session(solid, request, work);
  });
}

template <class Solid>
std::unique_ptr<HeldStable> stable_session_there(const Client& client,
                                                 const Solid& solid,
                                                 const Request& request,
                                                 const CallOptions& options) {
  return std::make_unique<HeldStable>(options, [&](const WorkOptions& work) {
    return client.begin_stable_session(solid, request, work);
  });
}

template <class Held>
py::class_<Held> bind_held(py::module_& module, const char* name) {
  return py::class_<Held>(module, name)
      .def_property_readonly("mesh", &Held::mesh)
      .def_property_readonly("tets_sent", &Held::tets_sent)
      .def_property_readonly("is_over", &Held::is_over)
      .def("update", &Held::template update<Volume>)
      .def("update", &Held::template update<Scene>)
      .def("end", &Held::end)
      .def("stop", &Held::stop);
}

/// Rows of a range's begin and end, in memory of their own.
template <std::vector<SlotRange> StableMesh::*ranges>
py::array rows_of(const StableMesh& mesh) {
  std::vector<std::int64_t> numbers;
  for (const SlotRange& range : mesh.*ranges) {
    numbers.push_back(static_cast<std::int64_t>(range.begin));
    numbers.push_back(static_cast<std::int64_t>(range.end));
  }
  return ArrayMaker().make(std::span<const std::int64_t>(numbers), 2);
}

/// An array of the columns, which holds the mesh of which it is, and by it their memory.
template <class Function>
auto of_columns(const Function& array) {
  return [array](const py::object& self) {
    const auto& mesh = self.cast<const StableMesh&>();
    return array(ArrayMaker(self), mesh.columns, mesh.header);
  };
}

void bind_stable_mesh(py::module_& module) {
  py::class_<StableMesh>(module, "StableMesh")
      .def_property_readonly(
          "header", [](const StableMesh& mesh) { return python::to_python(mesh.header); })
      .def_property_readonly(
          "points",
          of_columns([](const ArrayMaker& maker, const MeshColumns& columns,
                        const MeshHeader& header) { return maker.points(columns, header); }))
      .def_property_readonly(
          "tets",
          of_columns([](const ArrayMaker& maker, const MeshColumns& columns,
                        const MeshHeader& header) { return maker.tets(columns, header); }))
      .def_property_readonly(
          "regions", of_columns([](const ArrayMaker& maker, const MeshColumns& columns,
                                   const MeshHeader& h) { return maker.regions(columns, h); }))
      .def_property_readonly("empty_vertices", &rows_of<&StableMesh::empty_vertices>)
      .def_property_readonly("empty_tets", &rows_of<&StableMesh::empty_tets>)
      .def_property_readonly("changed_vertices", &rows_of<&StableMesh::changed_vertices>)
      .def_property_readonly("changed_tets", &rows_of<&StableMesh::changed_tets>)
      .def_readonly("renumbered", &StableMesh::renumbered);
}

}  // namespace

void bind_session(py::module_& module) {
  bind_held<HeldPlain>(module, "Session");
  module.def("session", &session_here<Volume>);
  module.def("session", &session_here<Scene>);
  module.def("session_there", &session_there<Volume>);
  module.def("session_there", &session_there<Scene>);
  bind_stable_mesh(module);
  bind_held<HeldStable>(module, "StableSession")
      .def("in_order", &HeldStable::in_order)
      .def("update_replaced", &HeldStable::update_replaced);
  module.def("stable_session", &stable_session_here<Volume>);
  module.def("stable_session", &stable_session_here<Scene>);
  module.def("stable_session_there", &stable_session_there<Volume>);
  module.def("stable_session_there", &stable_session_there<Scene>);
}

}  // namespace tetstream::python
