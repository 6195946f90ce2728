#include "tetstream/stream.h"

#include <utility>

#include "client/library/api/stream_impl.h"
#include "client/library/api/to_public.h"

namespace tetstream {
namespace {

/// Has the source count the mesh, unless it has.
Status await_header(MeshStream::Impl& stream) {
  if (!stream.failure.ok() || stream.header != nullptr) return stream.failure;
  return stream.failure = guarded([&]() -> Status {
           auto source = stream.begin(stream.work.cancellation());
           if (!source.ok()) return source.status();
           stream.source = *std::move(source);
           const auto header = stream.source->header();
           if (header.ok()) stream.header = *header;
           return to_public(header.status());
         });
}

Status read_chunk(MeshStream::Impl& stream) {
  return guarded([&]() -> Status {
    const auto chunk = stream.source->next();
    if (!chunk.ok()) return to_public(chunk.status());
    stream.ended = *chunk == nullptr;
    if (!stream.ended) stream.chunk = to_public(**chunk, *stream.header);
    return {};
  });
}

Status stopped() { return {StatusCode::kCancelled, "a callback of the caller's stopped it"}; }

}  // namespace

MeshStream::MeshStream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MeshStream::~MeshStream() = default;
MeshStream::MeshStream(MeshStream&&) noexcept = default;
MeshStream& MeshStream::operator=(MeshStream&&) noexcept = default;

Result<MeshHeader> MeshStream::header() {
  if (Status status = await_header(*impl_); !status.ok()) return status;
  return to_public(*impl_->header, impl_->source->mesh_id());
}

const Chunk* MeshStream::next() {
  if (!await_header(*impl_).ok() || impl_->ended) return nullptr;
  impl_->failure = read_chunk(*impl_);
  return impl_->failure.ok() && !impl_->ended ? &impl_->chunk : nullptr;
}

std::shared_ptr<const void> MeshStream::keep_chunk() const noexcept {
  return impl_->source ? impl_->source->keep() : nullptr;
}

Result<Statistics> MeshStream::finish() {
  if (!impl_->failure.ok()) return impl_->failure;
  if (impl_->ended) return to_public(impl_->source->facts());
  return Status(StatusCode::kFailedPrecondition,
                "there are chunks to come: call next until it returns null");
}

Status drain(MeshStream stream, const MeshSink& sink) {
  const Result<MeshHeader> header = stream.header();
  if (!header.ok()) return header.status();
  if (sink.header && !sink.header(*header)) return stopped();
  while (const Chunk* const chunk = stream.next()) {
    if (sink.chunk && !sink.chunk(*chunk)) return stopped();
  }
  const Result<Statistics> statistics = stream.finish();
  if (statistics.ok() && sink.statistics) sink.statistics(*statistics);
  return statistics.status();
}

}  // namespace tetstream
