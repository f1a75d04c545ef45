"""The Slurm cluster of tools/slurm.sh."""

from __future__ import annotations

import subprocess


def jobs() -> dict[str, str]:
    """The tasks that have not ended, with the reason why they wait."""
    lines = output("squeue", "--noheader", "--array", "--format=%i %r").splitlines()
    return dict(line.split(maxsplit=1) for line in lines)


def nodes() -> set[str]:
    """The states of the nodes."""
    return set(output("sinfo", "--noheader", "--Node", "--format=%t").split())


def scontrol(*args: str) -> None:
    """Changes the cluster."""
    subprocess.run(["scontrol", *args], check=True)


def start_waiting_tasks() -> None:
    """Starts the tasks of a failed node soon: by default, they would start after two minutes."""
    for task in [task for task, reason in jobs().items() if reason == "BeginTime"]:
        # Slurm refuses to start a task in the second in which it was ended: "credential revoked".
        scontrol("update", f"JobId={task}", "StartTime=now+2")


def output(*command: str) -> str:
    """The output of a command."""
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
