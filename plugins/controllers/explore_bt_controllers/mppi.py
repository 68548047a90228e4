"""Controller ``mppi``: many sampled motions a period, steering clear of what stands and what moves."""

from __future__ import annotations

from typing import ClassVar

from explore_bt.interfaces import API_VERSION, PluginOptions, RobotContext, Surroundings
from explore_bt.types import Path
from explore_bt_controllers.driving_law import DrivingLaw
from explore_bt_controllers.nearby import Nearby
from explore_bt_controllers.noise import NoiseBank
from explore_bt_controllers.options import MppiOptions
from explore_bt_controllers.path_following import PathFollowing
from explore_bt_controllers.sampled_law import SampledLaw

__all__ = ["Mppi"]


class Mppi(PathFollowing):
    """Follows a path by sampled predictive control, around obstacles and clear of what moves.

    Legs, turns in place and arrival are those of ``pursuit``.
    """

    name: ClassVar[str] = "mppi"
    api_version: ClassVar[int] = API_VERSION
    Options: ClassVar[type[PluginOptions]] = MppiOptions

    def __init__(self, options: MppiOptions) -> None:
        super().__init__(options)
        self._options = options
        self._nearby = Nearby()
        self._noise: NoiseBank

    def setup(self, context: RobotContext) -> None:
        """Draw the noise, learn the limits and compile the kernels."""
        options = self._options
        self._noise = NoiseBank(
            context.rng("mppi"),
            options.samples,
            options.steps,
            (options.speed_noise, options.turn_noise),
            options.noise_time / options.step_time,
        )
        super().setup(context)

    def see(self, surroundings: Surroundings) -> None:
        """See ``Controller.see``."""
        self._nearby.see(surroundings)

    def _law_for(self, path: Path) -> DrivingLaw:
        return SampledLaw(path, self._options, self._footprint_m, self._nearby, self._noise)
