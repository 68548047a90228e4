from __future__ import annotations

import gtsam
import numpy as np
import pytest
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.graph_distance import relative_covariances
from explore_bt_slam.pose_graph import Edge, PoseGraph
from explore_bt_slam.sweep import Sweep

from explore_bt.types import Pose2

SPREAD = np.diag([0.02, 0.01, 0.01]) ** 2


def loop(closed: int, seed: int = 0) -> tuple[PoseGraph, list[Pose2]]:
    """A ring of 24 keyframes with drift, of which the last ``closed`` may be closed onto the first."""
    rng = np.random.default_rng(seed)
    graph, truth = PoseGraph(), [Pose2.identity()]
    graph.begin(truth[0])
    step = Pose2(0.5, 0.0, 2.0 * np.pi / 24)
    for k in range(1, 24 + closed):
        truth.append(truth[-1].compose(step))
        noise = rng.normal(0.0, np.sqrt(np.diag(SPREAD)))
        graph.extend(Edge(k - 1, k, step.compose(Pose2(*noise)), SPREAD, False))
    return graph, truth


def off(graph: PoseGraph, truth: list[Pose2]) -> float:
    return max(graph.pose(k).distance_to(pose) for k, pose in enumerate(truth))


def test_closures_take_the_drift_out_of_a_loop() -> None:
    graph, truth = loop(closed=4)
    before = off(graph, truth)
    edges = [Edge(k, 24 + k, truth[k].between(truth[24 + k]), SPREAD / 16.0, True) for k in range(4)]
    assert graph.close(edges) == edges
    assert off(graph, truth) < 0.5 * before
    assert graph.pose(25).distance_to(graph.pose(1)) < 0.02


def test_a_closure_that_contradicts_the_graph_stays_out() -> None:
    graph, truth = loop(closed=4)
    assert graph.close(
        [Edge(k, 24 + k, truth[k].between(truth[24 + k]), SPREAD / 16.0, True) for k in range(3)]
    )
    before = graph.poses.copy()
    assert not graph.close([Edge(3, 27, Pose2(0.8, 0.0, 0.0), SPREAD / 16.0, True)])
    assert len([edge for edge in graph.edges if edge.is_closure]) == 3
    assert np.array_equal(graph.poses, before)


def test_relative_covariances_equal_the_joint_marginals_along_a_chain() -> None:
    graph, _ = loop(closed=1)
    ours = relative_covariances(graph.poses, graph.edges, 20)
    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    tight = gtsam.noiseModel.Diagonal.Sigmas(np.full(3, 1e-9))
    factors.add(gtsam.PriorFactorPose2(20, gtsam.Pose2(*graph.poses[20]), tight))
    for k, pose in enumerate(graph.poses):
        values.insert(k, gtsam.Pose2(*pose))
    for edge in graph.edges:
        noise = gtsam.noiseModel.Gaussian.Covariance(edge.covariance)
        r = edge.relative
        factors.add(gtsam.BetweenFactorPose2(edge.a, edge.b, gtsam.Pose2(r.x, r.y, r.yaw_rad), noise))
    marginals = gtsam.Marginals(factors, values)
    for k in (21, 24):
        yaw = graph.poses[k, 2]
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
        theirs = turn @ marginals.marginalCovariance(k) @ turn.T
        assert np.allclose(ours[k], theirs, rtol=0.02, atol=1e-7)


def test_a_closure_shortens_the_uncertainty_between_its_ends() -> None:
    graph, truth = loop(closed=1)
    before = relative_covariances(graph.poses, graph.edges, 24)[0]
    assert graph.close([Edge(0, 24, truth[0].between(truth[24]), SPREAD / 16.0, True)])
    after = relative_covariances(graph.poses, graph.edges, 24)[0]
    assert np.trace(after) < 0.1 * np.trace(before)


def test_a_restored_graph_has_the_same_poses_and_goes_on() -> None:
    graph, _ = loop(closed=1)
    again = PoseGraph()
    again.restore(graph.poses, list(graph.edges))
    assert np.array_equal(again.poses, graph.poses)
    again.extend(Edge(24, 25, Pose2(0.5, 0.0, 0.0), SPREAD, False))
    assert again.poses.shape == (26, 3)
    assert np.allclose(again.covariance(24), graph.covariance(24), rtol=1e-3)


def test_steps_that_know_nothing_do_not_make_the_graph_singular() -> None:
    sweep = Sweep(0.0, np.zeros((1, 2), np.float32), np.ones((1, 2), np.float32), np.zeros(1, np.bool_))
    end = BackEnd(loop_closures=False)
    newest = end.begin(sweep, Pose2.identity())
    for scale in (1e-12, 1e6, 1e18, np.nan):
        for _ in range(40):
            newest = end.extend(
                sweep,
                newest,
                Pose2(0.5, 0.0, 0.0),
                np.full((3, 3), scale) if np.isnan(scale) else np.eye(3) * scale,
            )
    assert end.poses[-1, 0] == pytest.approx(80.0, abs=1e-3)


def laps(count: int, per_lap: int) -> list[Pose2]:
    """The truth: rounds of a ring, half a metre a keyframe."""
    truth, step = [Pose2.identity()], Pose2(0.5, 0.0, 2.0 * np.pi / per_lap)
    for _ in range(1, count * per_lap):
        truth.append(truth[-1].compose(step))
    return truth


def closed(truth: list[Pose2], per_lap: int, false_share: float, seed: int) -> tuple[PoseGraph, int]:
    """A graph of laps that drift, each keyframe closed onto the lap before, and false closures in between.

    Returns:
        The graph, and how many false closures it was offered.
    """
    steps, lies = np.random.default_rng(seed), np.random.default_rng(seed + 1)
    graph, offered, tight = PoseGraph(), 0, SPREAD / 4.0
    graph.begin(truth[0])
    for k in range(1, len(truth)):
        noise = Pose2(*steps.normal(0.0, np.sqrt(np.diag(SPREAD))).tolist())
        graph.extend(Edge(k - 1, k, truth[k - 1].between(truth[k]).compose(noise), SPREAD, False))
        edges = []
        while lies.random() < false_share:
            to = int(lies.integers(k))
            wrong = Pose2(*lies.normal(0.0, [1.5, 1.5, 0.7]).tolist())
            edges.append(Edge(to, k, truth[to].between(truth[k]).compose(wrong), tight, True))
        offered += len(edges)
        if k >= per_lap:
            noise = Pose2(*steps.normal(0.0, np.sqrt(np.diag(tight))).tolist())
            edges.append(
                Edge(k - per_lap, k, truth[k - per_lap].between(truth[k]).compose(noise), tight, True)
            )
        graph.close(edges)
    return graph, offered


@pytest.mark.parametrize("seed", range(3))
def test_three_false_closures_in_ten_leave_the_graph_where_it_was(seed: int) -> None:
    truth = laps(4, 40)
    clean, _ = closed(truth, 40, 0.0, seed)
    graph, offered = closed(truth, 40, 0.3, seed)
    assert offered >= 0.3 * (offered + 120)  # closures onto the lap before
    moved_m = np.hypot(*(graph.poses - clean.poses)[:, :2].T)
    assert moved_m.max() < 0.05


def test_early_false_closures_that_nothing_contradicted_are_thrown_out_when_true_ones_are_refused() -> None:
    """Over the first lap the graph has nothing to doubt a lie by, as long as it lies within the drift."""
    truth, tight, rng = laps(3, 40), SPREAD / 4.0, np.random.default_rng(0)
    graph = PoseGraph()
    graph.begin(truth[0])
    lies = 0
    for k in range(1, len(truth)):
        step = truth[k - 1].between(truth[k])
        noise = Pose2(*rng.normal(0.0, np.sqrt(np.diag(SPREAD))).tolist())
        graph.extend(Edge(k - 1, k, step.compose(noise), SPREAD, False))
        if 34 <= k < 40:
            lies += len(graph.close([Edge(0, k, graph.pose(0).between(drifted(graph, k)), tight, True)]))
        if k >= 40:
            graph.close([Edge(k - 40, k, truth[k - 40].between(truth[k]), tight, True)])
    assert lies > 0
    assert graph.closures >= 70
    assert off_by(graph, truth) < 0.1


def drifted(graph: PoseGraph, k: int) -> Pose2:
    """A place that is three standard deviations from where a keyframe is believed to be, the worst way."""
    variances, directions = np.linalg.eigh(graph.covariance(k))
    return Pose2(*(graph.poses[k] + 3.0 * np.sqrt(variances[-1]) * directions[:, -1]).tolist())


def off_by(graph: PoseGraph, truth: list[Pose2]) -> float:
    """Worst error between any keyframe and the one a lap later or before, metres."""
    pairs = [(k - 40, k) for k in range(40, len(truth))]
    return max(graph.pose(a).between(graph.pose(b)).distance_to(truth[a].between(truth[b])) for a, b in pairs)
