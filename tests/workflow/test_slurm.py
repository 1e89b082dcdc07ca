"""The small config through a real one-node Slurm on the loopback address gives the bytes of a local run."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.workflow.conftest import Project, fresh, kill_group, without_seconds

CONF = Path("/etc/slurm/slurm.conf")  # the executor's jobs find it here only
NEEDED = ("slurmctld", "slurmd", "munged", "sbatch", "squeue", "runuser")

pytestmark = [
    pytest.mark.skipif(
        any(shutil.which(name) is None for name in NEEDED),
        reason="Slurm is not installed (Debian: slurm-wlm and munge)",
    ),
    pytest.mark.skipif(os.geteuid() != 0, reason="starting Slurm's daemons needs root"),
    pytest.mark.skipif(CONF.exists(), reason=f"{CONF} is there already: this machine has a Slurm of its own"),
]

SETTINGS = """\
ClusterName=miburi
SlurmctldHost=localhost(127.0.0.1)
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0
MinJobAge=300
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cpus} RealMemory=8000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
SlurmctldPort={ctld}
SlurmdPort={daemon}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
"""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def munge_answers() -> bool:
    return subprocess.run(["munge", "-n"], capture_output=True, check=False).returncode == 0


@pytest.fixture(scope="module")
def slurm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Slurm's daemons, for as long as the tests of this module last."""
    folder = tmp_path_factory.mktemp("slurm")
    for name in ("state", "spool"):
        (folder / name).mkdir()
    running = []
    if not munge_answers():
        Path("/run/munge").mkdir(parents=True, exist_ok=True)
        shutil.chown("/run/munge", "munge")
        munge = ["runuser", "-u", "munge", "--", "munged", "--foreground"]
        running.append(subprocess.Popen(munge, start_new_session=True, stderr=subprocess.DEVNULL))
    CONF.write_text(SETTINGS.format(folder=folder, ctld=free_port(), daemon=free_port(), cpus=os.cpu_count()))
    try:
        for _ in range(50):
            if munge_answers():
                break
            time.sleep(0.2)
        for daemon in (["slurmctld", "-D"], ["slurmd", "-D", "-N", "localhost"]):
            process = subprocess.Popen(
                daemon, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            running.append(process)
        for _ in range(60):
            state = subprocess.run(
                ["sinfo", "-h", "-o", "%t"], capture_output=True, text=True, check=False
            ).stdout
            if state.strip() == "idle":
                break
            time.sleep(0.5)
        else:
            pytest.fail(f"Slurm's node is {state.strip()!r} after half a minute, expected idle")
        yield
    finally:
        for process in reversed(running):
            kill_group(process)
        CONF.unlink()


def test_a_run_on_slurm_gives_the_bytes_of_a_local_run(
    slurm: None, finished: Project, tmp_path: Path
) -> None:
    project = fresh(tmp_path / "miburi")
    run = project.snakemake(
        "--configfile=config/test.yaml",
        "--workflow-profile=none",
        "--profile=profiles/slurm",
        "--jobs=4",
        "--latency-wait=5",
        "--slurm-init-seconds-before-status-checks=3",
        "--default-resources=slurm_partition=main",
        timeout=3000,
    )
    assert run.status == 0, run.terminal[-4000:]
    assert "SLURM jobid" in run.terminal or "slurm" in run.terminal.lower()
    local, remote = without_seconds(finished), without_seconds(project)
    assert set(local) == set(remote)
    assert [name for name in local if local[name] != remote[name]] == []
