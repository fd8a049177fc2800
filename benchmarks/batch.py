"""Many simulations at once against one after another: the vehicle at 20 m/s, c from 0.1 to 0.5 m.

Run ``python benchmarks/batch.py``; ``--members`` and ``--duration`` make it smaller.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import racs_bif as rb
from racs_bif.simulation.batch import BatchSettings


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--members", type=int, default=400)
    parser.add_argument("--duration", type=float, default=20.0, help="of each simulation, s")
    parser.add_argument("--alone", type=int, default=3, help="how many are made one by one")
    options = parser.parse_args()
    system = rb.load_model("racs", parameters={"u": 20.0})
    c = np.linspace(0.1, 0.5, options.members)
    began = time.process_time()
    done = rb.simulate_batch(
        system, options.duration, values={"c": c}, settings=BatchSettings(tolerance=1e-6)
    )
    together = (time.process_time() - began) / options.members
    failed = int(done.failed.sum())
    print(
        f"{options.members} at once, errors estimated: {1e3 * together:.1f} ms of processor time "
        f"each, {done.steps.mean():.0f} steps, largest error {np.nanmax(done.error):.1g}, "
        f"{failed} failed"
    )
    began = time.process_time()
    still = dict.fromkeys(system.states, 0.0)
    for value in c[:: max(options.members // options.alone, 1)][: options.alone]:
        rb.simulate(
            system.with_parameters({"c": float(value)}),
            options.duration,
            operator="realised",
            initial=still,
            history="constant",
            tolerance=1e-6,
        )
    alone = (time.process_time() - began) / options.alone
    print(f"one by one: {1e3 * alone:.0f} ms each, {alone / together:.0f} times as long")


if __name__ == "__main__":
    main()
