#include "tetstream/session.h"

#include <utility>

#include "client/library/api/session_impl.h"

namespace tetstream {

Session::Session(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

const Mesh& Session::mesh() const noexcept { return impl_->now->mesh; }
std::uint64_t Session::tets_sent() const noexcept { return impl_->now->tets_sent; }
Status Session::update(const Volume& volume) { return impl_->update(volume); }
Status Session::update(const Scene& scene) { return impl_->update(scene); }
bool Session::is_over() const noexcept { return impl_->over; }
Status Session::end() { return impl_->end(); }

}  // namespace tetstream
