# The DEM side: the program `amberfield`.
# `cargo xtask images` builds this image, in a folder with the program.
ARG BASE
FROM ${BASE}
COPY amberfield /usr/local/bin/
# A program made for a newer system than this one would not start.
RUN amberfield --version
ENTRYPOINT ["amberfield"]
