"""On what a benchmark ran: commit, processor, versions."""

from __future__ import annotations

import os
import platform
import subprocess
from pathlib import Path

__all__ = ["describe_machine"]

ROOT = Path(__file__).resolve().parent.parent


def describe_machine() -> str:
    """One line: commit, whether the tree was clean, processor, cores, Python."""
    commit = _git("rev-parse", "--short", "HEAD") or "no commit"
    dirty = " with local changes" if _git("status", "--porcelain", "--untracked-files=no") else ""
    return (
        f"commit {commit}{dirty}; {_processor()}, {os.cpu_count()} cores; Python {platform.python_version()}"
    )


def _git(*arguments: str) -> str:
    run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    return run.stdout.strip()


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
