"""Every picture is drawn on axes that are given, or on new ones, and returns them."""

import inspect
import pkgutil
from importlib import import_module

import matplotlib as mpl
import pytest

import racs_bif.plots
from racs_bif.plots.style import style

MODULES = [
    import_module(f"racs_bif.plots.{m.name}") for m in pkgutil.iter_modules(racs_bif.plots.__path__)
]
DRAWN = {
    f"{module.__name__}.{name}": function
    for module in MODULES
    for name, function in vars(module).items()
    if (name == "draw" or name.startswith("draw_"))
    and inspect.isfunction(function)
    and function.__module__ == module.__name__
    and not module.__name__.endswith("_layers")
}


def test_there_are_pictures():
    assert len(DRAWN) >= 15


@pytest.mark.parametrize("name", DRAWN)
def test_axes_may_be_given_and_are_returned(name):
    signature = inspect.signature(DRAWN[name])
    axes = signature.parameters.get("ax") or signature.parameters.get("axes")
    assert axes is not None
    assert axes.kind is axes.KEYWORD_ONLY
    assert axes.default is None
    assert signature.return_annotation in {"Axes", "tuple[Axes, ...]"}


def test_the_style_is_put_back():
    before = dict(mpl.rcParams)
    with style():
        assert mpl.rcParams["font.size"] == 8.0
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("fails", [False, True])
def test_a_notebook_goes_on_showing_figures(fails):
    # The backend of notebooks turns this on when the first figure is made, within the style.
    assert not mpl.is_interactive()
    try:
        with style():
            mpl.interactive(True)
            if fails:
                raise KeyError
    except KeyError:
        pass
    try:
        assert mpl.is_interactive()
    finally:
        mpl.interactive(False)
