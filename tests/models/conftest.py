import numpy as np
import pytest


@pytest.fixture
def places():
    """Return the values of a parameter at all points of a kind, in rising order."""

    def of(branch, label, name):
        return np.sort([p.parameters[name] for p in branch.special if p.label == label])

    return of
