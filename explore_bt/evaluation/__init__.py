"""How good a trajectory or an exploration is, by the field's own measures."""

from explore_bt.evaluation.exploration_trial import Decider, Decision, Trial, run_trial
from explore_bt.evaluation.offline_tour import KnownFloor, Tour, lookouts_of, watchman_tours
from explore_bt.evaluation.plain_frontier import PlainNearestFrontier
from explore_bt.evaluation.relations import (
    Relation,
    RelationErrors,
    read_relations,
    relation_errors,
)
from explore_bt.evaluation.set_cover import set_cover_tour_m
from explore_bt.evaluation.starts import spread_starts
from explore_bt.evaluation.trial_robot import MapDrawer, TrialRobot, TrialSettings, TrueWorld

__all__ = [
    "Decider",
    "Decision",
    "KnownFloor",
    "MapDrawer",
    "PlainNearestFrontier",
    "Relation",
    "RelationErrors",
    "Tour",
    "Trial",
    "TrialRobot",
    "TrialSettings",
    "TrueWorld",
    "lookouts_of",
    "read_relations",
    "relation_errors",
    "run_trial",
    "set_cover_tour_m",
    "spread_starts",
    "watchman_tours",
]
