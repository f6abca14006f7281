"""Command ``amberfield`` of the wheel."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import amberfield
import tomli_w
from conftest import command


def test_the_command_is_of_the_same_version():
    assert command("--version").stdout == f"amberfield {amberfield.__version__}\n"


def test_exit_codes_are_those_of_the_binary(tmp_path):
    assert command("run", tmp_path / "nothing.toml", check=False).returncode == 2
    assert command("no-such-command", check=False).returncode == 2


def test_a_new_scene_runs(tmp_path):
    command("new", "bed", cwd=tmp_path)
    done = command("run", "bed/scene.toml", "--out", "run", "--steps", "20", cwd=tmp_path)
    assert "results: run" in done.stdout
    assert len(amberfield.Run(tmp_path / "run").grains()) == 1000


def test_ctrl_c_stops_the_command_with_a_checkpoint(bed, tmp_path):
    bed["time"]["end_s"] = 10.0
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(bed))
    program = Path(sys.executable).with_name("amberfield")
    process = subprocess.Popen(
        [program, "run", "scene.toml", "--out", "run"], cwd=tmp_path, stderr=subprocess.PIPE
    )
    while not (tmp_path / "run" / "history.csv").exists():
        time.sleep(0.05)
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=30)
    assert process.returncode == 0
    assert amberfield.Run(tmp_path / "run").summary["ending"] == "interrupted"
