"""The steps of a branch in the log."""

import logging

from racs_bif.continuation import trace


def test_a_heading_stands_over_every_twenty_points(kinds, fold, caplog):
    with caplog.at_level(logging.INFO, logger="racs_bif.continuation"):
        branch = trace(fold, [1.0, 1.0], (0.0, 1.0), [kinds.Fold()], direction=-1)
    lines = caplog.messages
    rows = [line.split() for line in lines if line.split()[0].isdigit()]
    heads = [k for k, line in enumerate(lines) if line.split()[:2] == ["BR", "PT"]]
    assert [int(row[1]) for row in rows] == list(range(1, len(branch.points) + 1))
    assert len(rows) > 40
    assert heads == [1 + 21 * k for k in range(len(heads))]
    assert len(heads) == -(-len(rows) // 20)
    assert [row[2] for row in rows if row[2].isalpha()] == ["LP"]
