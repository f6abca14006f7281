"""Runs of scenes."""

import logging
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import amberfield
import numpy as np
import pytest
import tomli_w
from conftest import command


def test_a_dict_runs_as_a_file_does(bed, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(tomli_w.dumps(bed))
    ours = amberfield.run(bed, tmp_path / "dict", progress=False)
    theirs = amberfield.run(path, tmp_path / "file", progress=False)
    command("run", path, "--out", tmp_path / "command")
    physics = [name for name in ours.history.columns if not name.startswith("wall_s")]
    assert ours.history[physics].equals(theirs.history[physics])
    assert ours.history[physics].equals(amberfield.Run(tmp_path / "command").history[physics])
    assert ours.scene == theirs.scene and ours.summary["ending"] == "complete"


def test_numpy_in_a_dict_is_what_its_numbers_are(bed, tmp_path):
    bed["domain"]["max_m"] = np.array([0.01, 0.01, 0.02])
    bed["particles"]["generate"]["count"] = np.int64(20)
    bed["particles"]["generate"]["radius_m"] = np.float32(0.5).item() * 1e-3
    assert len(amberfield.run(bed, tmp_path / "run", progress=False, steps=10).grains()) == 20


def test_callbacks_get_the_grains_of_each_output(bed, tmp_path):
    heard = []
    run = amberfield.run(bed, tmp_path / "run", progress=False, callback=heard.append)
    assert [grains.step for grains in heard] == [0, 250, 500, 750, 1000]
    np.testing.assert_allclose([grains.time_s for grains in heard], run.times_s)
    assert len(run) == len(heard)
    for frame, grains in enumerate(heard):
        read = run.grains(frame)
        assert (read.step, read.time_s) == (grains.step, pytest.approx(grains.time_s))
        for name in ("id", "position_m", "velocity_m_s", "radius_m", "charge_C"):
            np.testing.assert_array_equal(getattr(read, name), getattr(grains, name), err_msg=name)


def test_a_callback_stops_a_run_which_then_goes_on_bit_for_bit(bed, tmp_path):
    whole = amberfield.run(bed, tmp_path / "whole", progress=False)
    part = amberfield.run(bed, tmp_path / "part", progress=False, callback=lambda grains: grains.step < 500)
    assert part.summary["ending"] == "interrupted" and part.summary["step"] == 500
    again = amberfield.run(bed, progress=False, resume=part.checkpoints[-1])
    assert again.path == part.path
    np.testing.assert_array_equal(again.grains().position_m, whole.grains().position_m)
    physics = [name for name in whole.history.columns if not name.startswith("wall_s")]
    assert again.history[physics].equals(whole.history[physics])


def test_an_exception_of_a_callback_is_raised_and_the_run_is_saved(bed, tmp_path):
    def callback(grains):
        if grains.step > 0:
            raise RuntimeError("seen enough")

    with pytest.raises(RuntimeError, match="seen enough"):
        amberfield.run(bed, tmp_path / "run", progress=False, callback=callback)
    assert amberfield.Run(tmp_path / "run").checkpoints
    # The next run of this process starts as if nothing had been.
    assert amberfield.run(bed, tmp_path / "next", progress=False, steps=5).summary["ending"] == "steps"


def test_ctrl_c_stops_with_a_checkpoint(bed, tmp_path):
    bed["time"]["end_s"] = 10.0
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(bed))
    script = textwrap.dedent(
        """
        import amberfield
        try:
            amberfield.run("scene.toml", "run", callback=lambda grains: print("frame", flush=True))
        except KeyboardInterrupt:
            print("interrupted", amberfield.Run("run").checkpoints[-1].name)
        """
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout.readline() == "frame\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=30)
    assert process.returncode == 0
    assert rest.splitlines()[-1].startswith("interrupted step_")
    assert amberfield.Run(tmp_path / "run").summary["ending"] == "interrupted"


def test_ctrl_c_while_the_bar_is_drawn_is_not_lost(bed, tmp_path, monkeypatch):
    bed["time"]["end_s"] = 10.0
    shown = []

    def show(*progress):
        shown.append(progress)
        if len(shown) == 3:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(amberfield._run._Bar, "show", lambda self, *progress: show(*progress))
    with pytest.raises(KeyboardInterrupt):
        amberfield.run(bed, tmp_path / "run")
    assert amberfield.Run(tmp_path / "run").summary["ending"] == "interrupted"
    assert amberfield.Run(tmp_path / "run").checkpoints


def test_there_is_one_run_at_a_time(bed, tmp_path):
    def inner(_):
        amberfield.run(bed, tmp_path / "inner", progress=False)

    with pytest.raises(amberfield.InputError, match="another run goes on"):
        amberfield.run(bed, tmp_path / "run", progress=False, callback=inner)


def test_a_run_in_a_thread_leaves_python_free(bed, tmp_path):
    done = []
    thread = threading.Thread(
        target=lambda: done.append(amberfield.run(bed, tmp_path / "run", progress=False))
    )
    thread.start()
    ticks = 0
    while thread.is_alive():
        ticks += 1
        time.sleep(0.001)
    assert done and ticks > 10


def test_progress_is_shown(bed, tmp_path, capfd):
    bed["time"]["end_s"] = 2e-2
    amberfield.run(bed, tmp_path / "run", steps=4000)
    assert "/10000" in capfd.readouterr().err


def test_warnings_reach_the_logger(bed, tmp_path, caplog):
    del bed["electric_field"]
    bed["particles"]["generate"]["charge_C"] = 0.0
    bed["time"]["gravity_m_s2"] = [0.0, 0.0, 0.0]
    with caplog.at_level(logging.INFO, "amberfield"):
        run = amberfield.run(bed, tmp_path / "run", progress=False, steps=5)
    assert any("200 grains" in record.message for record in caplog.records)
    assert any("200 grains" in line["fields"]["message"] for line in run.log)


def test_failures_have_the_text_of_the_command(bed, tmp_path):
    bed["time"]["step_s"] = -1.0
    path = tmp_path / "scene.toml"
    path.write_text(tomli_w.dumps(bed))
    with pytest.raises(amberfield.InputError) as caught:
        amberfield.run(path, tmp_path / "run", progress=False)
    theirs = command("run", path, "--out", tmp_path / "run", check=False)
    assert theirs.returncode == caught.value.exit_code == 2
    assert [f"error: {line}" for line in str(caught.value).splitlines()] == theirs.stderr.splitlines()
    with pytest.raises(amberfield.InputError, match="the scene: time.step_s"):
        amberfield.run(bed, tmp_path / "run", progress=False)
    assert not (tmp_path / "run").exists()


def test_a_run_outside_of_its_tolerance_is_written_and_raised(bed, tmp_path):
    bed["electric_field"] |= {"tolerance": 1e-4, "coupling_interval": 200}
    bed["particles"]["generate"]["charge_C"] = {"bipolar": 2e-12}
    bed["time"]["end_s"] = 4e-3
    with pytest.raises(amberfield.ToleranceError, match="forecasts"):
        amberfield.run(bed, tmp_path / "run", progress=False)
    assert amberfield.Run(tmp_path / "run").summary["ending"] == "complete"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (dict(scene="nowhere.toml"), "there is no file nowhere.toml"),
        (dict(scene={"time": None}), "time: the value is None"),
        (dict(scene={}), "domain"),
        (dict(set={"time.step": 1.0}), "step_s"),
        (dict(set={"electric_field": {"tolerance": "much"}}), "tolerance"),
        (dict(threads=0), "threads: got 0"),
        (dict(resume="nothing.amber"), "there is no run to continue"),
    ],
)
def test_nonsense_is_refused_with_words(bed, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises((amberfield.InputError, TypeError)) as caught:
        amberfield.run(**{"scene": bed, "out": "run", "progress": False, **arguments})
    assert words in str(caught.value)


def test_overrides_are_those_of_the_command(bed, tmp_path):
    overrides = {"time.end_s": 1e-5, "walls[0].material": "glass", "output.formats": ["vtk", "csv"]}
    run = amberfield.run(bed, tmp_path / "run", progress=False, set=overrides)
    assert run.summary["step"] == 5
    assert list((tmp_path / "run" / "particles").glob("*.csv"))


def test_a_folder_that_is_no_run_is_refused(tmp_path):
    with pytest.raises(amberfield.InputError, match="no run folder"):
        amberfield.Run(tmp_path)


def test_the_charge_on_walls_and_the_histogram_are_read(bed, tmp_path):
    bed["materials"].append({**bed["materials"][0], "name": "nylon", "work_function_eV": 4.0})
    bed["materials"][0]["work_function_eV"] = 5.0
    bed["walls"] = [dict(bed["walls"][0], material="nylon", charging="insulating")]
    bed["electric_field"]["enable_collision_charge_transfer"] = True
    bed["particles"]["generate"] |= {"velocity_m_s": [0.0, 0.0, -1.0]}
    run = amberfield.run(bed, tmp_path / "run", progress=False)
    walls = run.walls()
    assert len(walls) > 0
    np.testing.assert_allclose(walls["charge_C"].sum(), run.history["wall_charge_C"].iloc[-1], rtol=1e-9)
    assert {"step", "time_s"} <= set(run.charge_histogram.columns)
    assert "normal_z_N" in run.wall_forces.columns


def test_runs_over_openfoam_are_refused_with_words_where_there_is_none(bed, tmp_path, monkeypatch):
    monkeypatch.delenv("AMBERFIELD_SOLVER", raising=False)
    bed["solver"] = {"openfoam_case": os.fspath(tmp_path / "no-case")}
    with pytest.raises(amberfield.AmberfieldError, match="no such folder"):
        amberfield.run(bed, tmp_path / "run", progress=False)
