// A mesh taken chunk by chunk from a server, and stopped early.
//   take_chunks HOST:PORT FILE.vdb
#include <cstddef>
#include <cstdio>
#include <string>
#include <tetstream/tetstream.h>
#include <vector>

namespace {

/// The whole mesh, as a solver would gather it: allocated once, filled as chunks come.
tetstream::Status gather(const tetstream::Client& client,
                         const tetstream::StoredVolume& volume) {
  // [stream]
  tetstream::MeshStream stream = client.stream(volume);
  const auto header = stream.header();
  if (!header.ok()) return header.status();
  std::vector<double> points;
  points.reserve(3 * header->vertex_count);
  std::size_t tets = 0;
  while (const tetstream::Chunk* chunk = stream.next()) {
    for (std::size_t i = 0; i < chunk->vertex_count; ++i) {
      const tetstream::Point point = chunk->columns.point(i);
      for (std::size_t axis = 0; axis < 3; ++axis)
        points.push_back(header->origin[axis] + point[axis]);
    }
    tets += chunk->tet_count;
  }
  const auto statistics = stream.finish();  // why there are no more chunks
  if (!statistics.ok()) return statistics.status();
  // [stream]
  std::printf("%zu vertices, %zu tets\n", points.size() / 3, tets);
  return {};
}

/// As many chunks as make a thousand tets; then the server may stop.
tetstream::Status look(const tetstream::Client& client, const tetstream::StoredVolume& volume) {
  // [sink]
  std::size_t seen = 0;
  const tetstream::Status status = tetstream::drain(
      client.stream(volume), {.chunk = [&](const tetstream::Chunk& chunk) {
        seen += chunk.tet_count;
        return seen < 1000;  // false stops the stream, and the server's work for it
      }});
  // [sink]
  std::printf("stopped after %zu tets\n", seen);
  return status.code() == tetstream::StatusCode::kCancelled ? tetstream::Status() : status;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "take_chunks HOST:PORT FILE.vdb\n"), 2;
  const tetstream::Client client = tetstream::Client::connect(argv[1]).value();
  const tetstream::StoredVolume volume = client.upload_file(argv[2]).value();
  gather(client, volume).or_throw();
  look(client, volume).or_throw();
  return 0;
} catch (const tetstream::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
