"""The rollout kernel against a slow version that shares nothing with it but the velocity law."""

import math

import numpy as np
import pytest
from explore_bt_controllers.limiter import next_velocity
from explore_bt_controllers.noise import NoiseBank
from explore_bt_controllers.proposals import propose
from explore_bt_controllers.rollout import BLOCK, Bounds, Field, Prices, Route, Start, World, costs_of
from scipy.ndimage import map_coordinates

BOUNDS = Bounds(-0.1, 0.5, 0.5, 2.0, 1.2, 2.0, 8.0)
STEPS, STEP_S = 30, 0.08


def world(seed):
    """A bend, a field of random distances, two walkers, a robot somewhere near the begin of the bend."""
    rng = np.random.default_rng(seed)
    along = np.arange(0.0, 3.0, 0.02)
    bend = rng.uniform(-0.8, 0.8)
    heading = bend * along
    x, y = np.cumsum(np.cos(heading)) * 0.02, np.cumsum(np.sin(heading)) * 0.02
    curvature, rate = np.full(along.size, bend), np.zeros(along.size)
    wanted = rng.uniform(0.1, 0.5, along.size)
    samples = np.column_stack((x, y, np.cos(heading), np.sin(heading), curvature, rate, wanted))
    room = rng.uniform(0.1, 0.8, (60, 50)).astype(np.float32)
    walk = STEP_S * np.arange(1, STEPS + 1)[:, None] * rng.uniform(-1.0, 1.0, (2, 1, 2))
    discs = np.moveaxis(rng.uniform(-0.5, 1.5, (2, 1, 2)) + walk, 0, 1)
    moving = np.concatenate((discs, np.broadcast_to([0.5, 0.4], discs.shape)), axis=2)
    start = Start(*rng.uniform(-0.1, 0.1, 3), *rng.uniform(0.0, 0.3, 2), *rng.uniform(-0.3, 0.3, 2), 0.0)
    prices = Prices(widest=0.1, hard=0.3, soft=0.5)
    return World(start, BOUNDS, Route(samples, 0.02), Field(room, -1.0, -1.0, 0.05), moving, prices, STEP_S)


def slow_cost(world, asked):
    """Cost of one sample; asked: (2, K)."""
    start, bounds, prices = world.start, world.bounds, world.prices
    x, y, yaw, along = start.x, start.y, start.yaw, start.along
    v, a, w, b = start.linear, start.linear_gain, start.angular, start.angular_gain
    total = 0.0
    for k in range(asked.shape[1]):
        v0, w0 = v, w
        v = next_velocity(
            v0, a, asked[0, k], 0.0, STEP_S, bounds.lowest, bounds.highest, bounds.acceleration, bounds.jerk
        )
        w = next_velocity(w0, b, asked[1, k], 0.0, STEP_S, -1.2, 1.2, 2.0, 8.0)
        a, b = (v - v0) / STEP_S, (w - w0) / STEP_S
        way, turn = 0.5 * (v0 + v) * STEP_S, 0.5 * (w0 + w) * STEP_S
        x, y = x + way * math.cos(yaw + 0.5 * turn), y + way * math.sin(yaw + 0.5 * turn)
        yaw += turn
        i = min(max(int((along + way) / 0.02), 0), len(world.route.samples) - 1)
        px, py, tx, ty, bend, _, wanted = world.route.samples[i]
        lateral = (y - py) * tx - (x - px) * ty
        along = i * 0.02 + ((x - px) * tx + (y - py) * ty) / max(1.0 - bend * lateral, 0.3)
        facing = math.cos(yaw) * tx + math.sin(yaw) * ty
        total += prices.speed * (wanted - v * facing) ** 2 / (bounds.highest * (wanted + 0.05))
        total += prices.deviation * lateral**2 / (lateral**2 + 0.15**2) + prices.offset * abs(lateral)
        total += prices.beyond * max(abs(lateral) - prices.widest, 0.0) + prices.heading * (1.0 - facing)
        total += (
            prices.acceleration * a * a + prices.turn_acceleration * b * b + prices.reverse * max(-v, 0.0)
        )
        total += price_of_place(world, k, x, y, v)
    return STEP_S * total


def price_of_place(world, k, x, y, v):
    field, prices = world.field, world.prices
    at = [[(y - field.y0) / field.resolution], [(x - field.x0) / field.resolution]]
    room = float(map_coordinates(field.room.astype(float), at, order=1, mode="nearest")[0])
    haste = v / world.bounds.highest
    tight = np.clip((prices.soft - room) / (prices.soft - prices.hard), 0.0, 1.0)
    price = prices.room * (tight * haste) ** 2
    if room < prices.hard:
        price += prices.touch + prices.depth * (prices.hard - room)
    for ox, oy, reach, band in world.moving[k]:
        spare = math.hypot(x - ox, y - oy) - reach
        price += prices.near * np.clip(1.0 - spare / band, 0.0, 1.0) ** 2
        if spare < 0.0:
            price += (prices.touch - prices.depth * spare) * (0.02 + abs(haste))
    return price


def sequences(blocks):
    """(N, K) of (G, K, BLOCK)."""
    return np.moveaxis(blocks, 1, 2).reshape(-1, blocks.shape[1])


@pytest.mark.parametrize("seed", range(8))
def test_costs_are_those_of_a_slow_version(seed):
    rng = np.random.default_rng(seed)
    scene = world(seed)
    bank = rng.normal(0.0, 0.3, (2, 4, STEPS, BLOCK)).astype(np.float32)
    targets = np.stack((rng.uniform(-0.2, 0.6, STEPS), rng.uniform(-0.5, 0.5, STEPS)))
    costs = costs_of(scene, targets, bank, (1, 2), 200)
    asked = [np.stack((v, w)) for v, w in zip(sequences(bank[0, 1:]), sequences(bank[1, 2:]), strict=False)]
    slow = [slow_cost(scene, targets + each) for each in asked[:200]]
    assert np.allclose(costs, slow, rtol=1e-4, atol=1e-3)


def test_the_first_proposal_follows_the_path():
    scene = world(0)._replace(moving=np.empty((STEPS, 0, 4)), prices=Prices(widest=1.0, hard=0.0, soft=0.1))
    asked = propose(scene, STEPS, 0.3, 1.0)
    count = asked.shape[2]
    block = np.pad(asked[:, None], ((0, 0), (0, 0), (0, 0), (0, BLOCK - count)))
    costs = costs_of(scene, np.zeros((2, STEPS)), block, (0, 0), count)
    assert costs.argmin() == 0


def test_noise_comes_in_opposite_pairs_that_hang_together_in_time():
    bank = NoiseBank(np.random.default_rng(0), 200, STEPS, (0.1, 0.4), 4.0).sequences
    assert np.array_equal(bank[..., 0::2], -bank[..., 1::2])
    after, before = bank[:, :, 1:, ::2], bank[:, :, :-1, ::2]
    assert np.corrcoef(after.ravel(), before.ravel())[0, 1] > 0.9
    assert np.allclose(bank[..., ::8].std(axis=(1, 2, 3)), [0.1, 0.4], rtol=0.1)
    assert np.allclose(
        bank[..., 6::8].std(axis=(1, 2, 3)), 0.1 * bank[..., ::8].std(axis=(1, 2, 3)), rtol=0.1
    )


def test_the_mean_of_the_noise_is_that_of_the_samples_used():
    rng = np.random.default_rng(1)
    noise = NoiseBank(rng, 200, STEPS, (0.1, 0.4), 4.0)
    weights = rng.random(200).astype(np.float32)
    firsts = noise.runs()
    slow = [weights @ sequences(noise.sequences[row, first:])[:200] for row, first in enumerate(firsts)]
    assert np.allclose(noise.mean(firsts, weights), slow, atol=1e-4)
