"""Campaigns in jobs of Slurm's: the script of a job, what may be asked for, and which options exclude each other.

No Slurm is needed: a program that is called sbatch runs the script in the background.
"""

import os
import subprocess
import sys

import pytest
from rings import small_rings

from pockmark import PockmarkError
from pockmark.cli.pools import pool_of
from pockmark.run.store import RunFolder
from pockmark.study.campaign import cases, load
from pockmark.study.runner import place
from pockmark.study.slurm import Slurm, batch_of, started

TABLE = {"queue": "short", "walltime": "12:00:00", "cores": 8, "memory": "16 GB"}
CAMPAIGN = """
scene = "rings.toml"
coarse = true
slurm = { queue = "short", walltime = "00:10:00", cores = 1, memory = "2 GB" }

[[group]]
name = "speeds"
sweep = { "impact.speed" = ["2 km/s"] }
"""
SBATCH = """#!/bin/sh
cp "$1" "$SUBMITTED"
setsid sh "$SUBMITTED" >"$SUBMITTED.log" 2>&1 &
echo $! >"$SUBMITTED.pid"
echo "Submitted batch job 17"
"""
SCANCEL = """#!/bin/sh
kill -- -$(cat "$SUBMITTED.pid")
"""


@pytest.fixture
def folder(tmp_path):
    """A campaign of one run."""
    small_rings("4 ns").save(tmp_path / "rings.toml")
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    return tmp_path


def test_the_script_of_a_job_asks_for_what_the_table_says(tmp_path):
    with batch_of(Slurm(**TABLE), tmp_path / "logs") as batch:
        lines = batch.job_script().splitlines()
    print(*lines, sep="\n")
    asked = {line.removeprefix("#SBATCH ") for line in lines if line.startswith("#SBATCH")}
    assert {"-p short", "-t 12:00:00", "-n 1", "--cpus-per-task=8", "--mem=15G"} <= asked
    assert {line.split("/dask-worker")[0] for line in asked if line[:2] in ("-e", "-o")} == {
        f"-e {tmp_path}/logs",
        f"-o {tmp_path}/logs",
    }
    (command,) = (line for line in lines if "dask" in line and not line.startswith("#"))
    assert command.startswith(sys.executable)
    assert "--nthreads 1 " in command  # one run at a time, on all cores of the job


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("queue", "a b", "slurm.queue: found 'a b', expected the name of a queue"),
        ("walltime", "12 h", "slurm.walltime: found '12 h', expected hours, minutes and seconds such as"),
        ("walltime", "12:61:00", "slurm.walltime"),
        ("cores", 0, "slurm.cores: found 0, input should be greater than or equal to 1"),
        ("cores", "8", "slurm.cores: found '8', input should be a valid integer"),
        ("memory", "16", "slurm.memory: found '16', expected a whole number of MB, GB or TB"),
        ("memory", "16 GB\n#SBATCH -A mine", "slurm.memory"),
        ("nodes", 3, "slurm.nodes: unknown key"),
    ],
)
def test_a_slip_in_the_table_is_one_sentence(key, value, expected, folder):
    text = TABLE | {key: value}
    rows = "".join(f"{k} = {v!r}\n" for k, v in text.items()).replace("'", '"')
    (folder / "campaign.toml").write_text(
        CAMPAIGN.replace('slurm = { queue = "short", walltime = "00:10:00", cores = 1, memory = "2 GB" }', "")
        + f"[slurm]\n{rows}"
    )
    with pytest.raises(PockmarkError) as caught:
        load(folder)
    print(caught.value)
    assert expected in str(caught.value)


def test_a_table_that_lacks_a_key_says_which(folder):
    text = (folder / "campaign.toml").read_text().replace('queue = "short", ', "")
    (folder / "campaign.toml").write_text(text)
    with pytest.raises(PockmarkError, match=r"slurm.queue: is missing"):
        load(folder)


@pytest.mark.parametrize(
    ("jobs", "scheduler", "slurm", "expected"),
    [
        (None, "tcp://node1:8786", TABLE, "--slurm: starts a scheduler of its own, --scheduler excludes it"),
        (2, "tcp://node1:8786", None, "--jobs: --scheduler excludes it, for the scheduler has its workers"),
    ],
)
def test_options_that_exclude_each_other_are_told(jobs, scheduler, slurm, expected, tmp_path):
    table = slurm and Slurm(**slurm)
    with pytest.raises(PockmarkError, match=expected), pool_of(jobs, scheduler, table, tmp_path):
        pass


def test_slurm_without_a_table_or_without_sbatch_is_told(folder, monkeypatch, tmp_path):
    (folder / "campaign.toml").write_text(CAMPAIGN.replace("slurm = ", "set = {} # "))
    code, _, mistakes = command(folder, os.environ)
    assert code == 2
    assert "--slurm: campaign.toml has no table [slurm]: queue, walltime, cores, memory" in mistakes
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(PockmarkError, match="there is no sbatch here"), started(Slurm(**TABLE), 1, tmp_path):
        pass


def command(folder, environment):
    """`pockmark study . --slurm` there: its exit code, what it printed, its mistakes."""
    done = subprocess.run(
        [sys.executable, "-m", "pockmark", "study", ".", "-o", "runs", "--slurm"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )
    print(done.stdout, done.stderr)
    return done.returncode, done.stdout, done.stderr


def test_a_campaign_runs_in_a_job(folder):
    programs = folder / "bin"
    programs.mkdir()
    for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    submitted = folder / "submitted.sh"
    path = os.pathsep.join([str(programs), os.environ["PATH"]])
    found = os.pathsep.join(filter(None, sys.path))
    code, said, mistakes = command(
        folder, os.environ | {"PATH": path, "PYTHONPATH": found, "SUBMITTED": str(submitted)}
    )
    log = folder / "submitted.sh.log"
    print(log.read_text() if log.exists() else "no job")
    assert (code in (0, 3), mistakes) == (True, "")
    assert "jobs that Slurm is asked for: 1, " in said
    assert "#SBATCH -t 00:10:00" in submitted.read_text()
    for case in cases(load(folder), folder, quick=False, only=[]):
        manifest = RunFolder(place(folder / "runs", case)).manifest()
        assert (manifest["status"], manifest["threads"]) == ("finished", 1)
