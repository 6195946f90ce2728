# The tetstream server, and the command line beside it. Build it from the repository's root:
#   docker build -f docker/server.Dockerfile -t tetstream .
# The packages and the build are the scripts' own, so they cannot drift from scripts/demo.

FROM debian:bookworm-slim AS build
WORKDIR /tetstream
COPY scripts/install_packages scripts/common.sh scripts/packages.txt scripts/
RUN scripts/install_packages build page && rm -rf /var/lib/apt/lists/*
COPY . .
RUN scripts/build release tetstream tetstreamd page \
    && for component in common command server; do \
        cmake --install build/release --prefix /opt/tetstream --strip --component "$component" || exit; \
    done

FROM debian:bookworm-slim
COPY scripts/install_packages scripts/common.sh scripts/packages.txt /tmp/scripts/
RUN /tmp/scripts/install_packages run \
    && rm -rf /tmp/scripts /var/lib/apt/lists/* \
    && useradd --uid 10001 --user-group --no-create-home --shell /usr/sbin/nologin tetstream \
    && install --directory --owner=tetstream --group=tetstream /var/lib/tetstream
COPY --from=build /opt/tetstream /usr/local

USER tetstream
ENV TETSTREAM_LISTEN=0.0.0.0:7447 TETSTREAM_STORE=/var/lib/tetstream
VOLUME /var/lib/tetstream
EXPOSE 7447
HEALTHCHECK --interval=10s --timeout=5s --start-period=10s \
    CMD ["tetstream", "health", "--server", "127.0.0.1:7447"]
# The server handles SIGTERM itself and needs no init above it.
ENTRYPOINT ["tetstreamd"]
