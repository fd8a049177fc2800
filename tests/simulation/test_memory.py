import numpy as np
import pytest

from racs_bif.fractional.laws import Law, PowerSum
from racs_bif.simulation.memory import METHODS, ExponentialMemory, FullMemory


def row(*terms):
    c, e = zip(*terms, strict=True)
    return PowerSum(np.array(c, dtype=float), np.array(e, dtype=float))


LAWS = (
    Law(row((1, 0), (1, 0.7)), row((1, 0), (1, 0.3)), "a"),
    Law(row((1, 0)), row((1, 0), (2, 1), (0.5, 1.5)), "b"),
)


def outputs(memory, inputs):
    found = []
    for e in inputs:
        w = memory.gain * e + memory.known()
        memory.push(e, w)
        found.append(w)
    return np.array(found)


@pytest.fixture
def inputs():
    t = 0.01 * np.arange(1, 3001)
    return np.column_stack([np.sin(t) + 0.3, np.exp(-t) * np.cos(5.0 * t)])


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_the_fast_memory_agrees_with_the_full_one_to_its_tolerance(inputs, tolerance):
    full = outputs(METHODS["bdf2"](LAWS, 0.01, len(inputs), 0.0), inputs)
    fast = outputs(ExponentialMemory(LAWS, 0.01, len(inputs), tolerance), inputs)
    # Errors of weights add up over the past, which reaches 80 times as far as the near field.
    assert np.abs(fast - full).max() <= 30.0 * tolerance * np.abs(full).max()


def test_the_full_memory_is_a_convolution(inputs):
    weights = np.random.default_rng(1).normal(size=(2, 301))
    got = outputs(FullMemory(weights), inputs[:300])
    for k in range(2):
        assert got[:, k] == pytest.approx(np.convolve(weights[k], inputs[:300, k])[:300])


def test_the_cost_of_a_fast_step_does_not_grow(inputs):
    costs = {}
    for name in ("bdf2", "fast"):
        memory = METHODS[name](LAWS, 0.01, len(inputs), 1e-8)
        costs[name] = []
        for e in inputs[:1000]:
            costs[name].append(memory.touched)
            memory.push(e, memory.gain * e + memory.known())
    assert len(set(costs["fast"])) == 1
    assert costs["bdf2"][-1] == 2 * 2 * 999
    longer = ExponentialMemory(LAWS, 0.01, 10**6, 1e-8)
    assert longer.touched < 1.5 * costs["fast"][0]


def test_the_fast_memory_takes_an_unstable_pole(inputs):
    law = Law(row((1, 0)), row((-1, 0), (1, 1)), "c")  # w' = w + e
    memory = ExponentialMemory((law,), 0.01, 500, 1e-8)
    w = outputs(memory, np.ones((500, 1)))[:, 0]
    assert w[-1] == pytest.approx(np.exp(5.0) - 1.0, rel=0.01)
