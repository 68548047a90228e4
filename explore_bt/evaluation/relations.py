"""Error of a trajectory over relations that people have verified.

The metric of Kümmerle, Steder, Dornhege, Ruhnke, Grisetti, Stachniss, Kleiner: "On measuring the accuracy of
SLAM algorithms", Autonomous Robots 27 (2009), eq. 4: for each relation δ* between two poses, the error is
δ ⊖ δ*, of which the translation's length and the rotation's size are averaged over all relations.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import LogError
from explore_bt.types import Pose2, Trajectory

__all__ = ["Relation", "RelationErrors", "read_relations", "relation_errors"]

_FIELDS = ("t1", "t2", "x", "y", "z", "roll", "pitch", "yaw")
_MICROSECONDS = 1e6


@dataclass(frozen=True, slots=True)
class Relation:
    """Where the robot stood at ``to_s``, seen from where it stood at ``from_s`` (the log's own stamps)."""

    from_s: float
    to_s: float
    T_from_to: Pose2


@dataclass(frozen=True, slots=True, eq=False)
class RelationErrors:
    """The errors of a trajectory, one entry a relation.

    Attributes:
        translations_m: (N,) float64, metres.
        rotations_rad: (N,) float64, radians, >= 0.
        missing: relations left out because the trajectory has no pose at one of their stamps.
    """

    translations_m: NDArray[np.float64]
    rotations_rad: NDArray[np.float64]
    missing: int

    def as_dict(self) -> dict[str, float]:
        """The published figures: means and standard deviations (over all N), metres and degrees."""
        degrees = np.degrees(self.rotations_rad)
        return {
            "count": len(self.translations_m),
            "missing": self.missing,
            "translation_mean_m": float(self.translations_m.mean()),
            "translation_sd_m": float(self.translations_m.std()),
            "rotation_mean_deg": float(degrees.mean()),
            "rotation_sd_deg": float(degrees.std()),
        }


def read_relations(path: Path) -> tuple[Relation, ...]:
    """Relations from lines ``t1 t2 x y z roll pitch yaw``, metres and radians: t2's pose in the frame of t1.

    Blank lines and lines that begin with ``#`` are passed over. Of a planar robot z, roll and pitch say
    nothing and are not used.

    Raises:
        LogError: no such file, or a line that is no relation; names the line.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise LogError(
            f"{path}: cannot be read ({(error.strerror or str(error)).lower()}); give a file of relations"
        ) from None
    numbered = ((number, line.strip()) for number, line in enumerate(lines, start=1))
    relations = tuple(
        _relation(path, number, line) for number, line in numbered if line and not line.startswith(b"#")
    )
    if not relations:
        raise LogError(f"{path}: holds no relation; expected lines of {' '.join(_FIELDS)}")
    return relations


def relation_errors(trajectory: Trajectory, relations: Sequence[Relation]) -> RelationErrors:
    """The error of every relation whose two stamps the trajectory has (to the microsecond).

    Args:
        trajectory: with the log's own stamps, in any order; of several poses with one stamp the first counts.
        relations: at least one.

    Raises:
        LogError: not one relation has both its stamps in the trajectory: it belongs to another log.
    """
    rows: dict[int, int] = {}
    for row, key in enumerate(_keys(trajectory.stamps_s)):
        rows.setdefault(key, row)
    ends = [(rows.get(_key(one.from_s)), rows.get(_key(one.to_s)), one) for one in relations]
    errors = np.array(
        [
            _error(trajectory.poses[begin], trajectory.poses[end], one.T_from_to)
            for begin, end, one in ends
            if begin is not None and end is not None
        ]
    ).reshape(-1, 2)
    if not len(errors):
        raise LogError(
            f"none of the {len(relations)} relations has both its stamps in the trajectory "
            f"(the first is from {relations[0].from_s:.6f} s); are they of another log?"
        )
    return RelationErrors(errors[:, 0], errors[:, 1], len(relations) - len(errors))


def _error(begin: NDArray[np.float64], end: NDArray[np.float64], true: Pose2) -> tuple[float, float]:
    off = true.between(Pose2(*begin.tolist()).between(Pose2(*end.tolist())))
    return math.hypot(off.x, off.y), abs(off.yaw_rad)


def _relation(path: Path, number: int, line: bytes) -> Relation:
    words = line.decode("ascii", errors="replace").split()
    place = f"{path}:{number}"
    if len(words) != len(_FIELDS):
        raise LogError(f"{place}: found {len(words)} words; expected 8: {' '.join(_FIELDS)}")
    values = [_number(place, name, word) for name, word in zip(_FIELDS, words, strict=True)]
    from_s, to_s, x, y, *_, yaw_rad = values
    return Relation(from_s, to_s, Pose2(x, y, yaw_rad))


def _number(place: str, name: str, word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LogError(f'{place}: {name} is "{word}"; expected a finite number')
    return value


def _keys(stamps_s: NDArray[np.float64]) -> list[int]:
    return [_key(stamp_s) for stamp_s in stamps_s.tolist()]


def _key(stamp_s: float) -> int:
    return round(stamp_s * _MICROSECONDS)
