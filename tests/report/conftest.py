"""A headless Chromium, installed where it is missing and may be, and the known diagram."""

import os
import runpy
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

_KNOWN = runpy.run_path(str(Path(__file__).parents[1] / "results" / "conftest.py"))
PACKAGES = ("chromium", "chromium-driver")
DRIVERS = ("chromedriver", "chromium-driver")
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--window-size=1280,800",
)
_MINUTES = 8


@pytest.fixture
def known():
    return SimpleNamespace(**{k: _KNOWN[k] for k in ("equilibria", "orbits", "system_info")})


def _found():
    driver = next(filter(None, map(shutil.which, DRIVERS)), None)
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    return (browser, driver) if browser and driver else None


def _install():
    """Install Debian's packages; return what went wrong."""
    if os.geteuid() or not shutil.which("apt-get"):
        return "not root on a Debian system"
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (
        ["apt-get", "-o", "Acquire::Retries=3", "update", "-qq"],
        ["apt-get", "-o", "Acquire::Retries=3", "install", "-y", "-qq", *PACKAGES],
    ):
        done = subprocess.run(
            command,
            env=environment,
            capture_output=True,
            text=True,
            timeout=60 * _MINUTES,
            check=False,
        )
        if done.returncode:
            return f"{' '.join(command)}: {done.stderr.strip()[-300:]}"
    return ""


@pytest.fixture(scope="session")
def programs():
    """Return Chromium and its driver; without them skip outside CI and fail in CI."""
    found, trouble = _found(), ""
    if found is None and os.environ.get("CI"):
        trouble = _install()
        found = _found()
        assert found, f"Chromium is wanted in CI and could not be installed: {trouble}"
    if found is None:
        pytest.skip("no Chromium with its driver here: apt-get install chromium chromium-driver")
    return found


@pytest.fixture(scope="session")
def browser(programs, tmp_path_factory):
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(programs[1]))
    driver.set_script_timeout(60)
    driver.set_page_load_timeout(120)
    yield driver
    driver.quit()
