# The OpenFOAM side: `electricFieldFoam`, `amberPimpleFoam` and their library.
# `cargo xtask images` builds this image, in a folder with all three.
ARG BASE
FROM ${BASE} AS package
RUN apt-get update \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends openfoam \
 && rm -rf /var/lib/apt/lists/*

FROM package
COPY solve.sh electricFieldFoam amberPimpleFoam libelectricField.so selfTest /opt/amberfield/
ENV WM_PROJECT_DIR=/usr/share/openfoam PATH=/opt/amberfield:${PATH} LD_LIBRARY_PATH=/opt/amberfield
RUN selfTest
ENTRYPOINT ["solve.sh"]
