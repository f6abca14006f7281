# One machine of several: both sides and an SSH server, by which `mpirun` starts a solver's ranks on other
# machines than the run's. Tests make two of them.
# `cargo xtask images` builds this image, in a folder with all programs.
ARG BASE
FROM ${BASE} AS package
RUN apt-get update \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends openfoam \
 && rm -rf /var/lib/apt/lists/*

FROM package AS server
RUN apt-get update \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends openssh-server procps \
 && rm -rf /var/lib/apt/lists/* && mkdir -p /run/sshd

FROM server
COPY amberfield electricFieldFoam amberPimpleFoam libelectricField.so selfTest /opt/amberfield/
ENV WM_PROJECT_DIR=/usr/share/openfoam PATH=/opt/amberfield:${PATH} LD_LIBRARY_PATH=/opt/amberfield
RUN selfTest && amberfield --version
ENTRYPOINT ["/usr/sbin/sshd", "-D", "-e"]
