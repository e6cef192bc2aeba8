"""Shared by all tests."""

import gc

import fmpy.logging
import pytest
from hypothesis import settings

from components import REGISTRY
from components.contract import plugins

settings.register_profile("sample", max_examples=30, deadline=None)
settings.register_profile("thorough", max_examples=1000, deadline=None)
settings.load_profile("sample")  # --hypothesis-profile=thorough for more


_add_logger_proxy, _loggers = fmpy.logging.addLoggerProxy, []


def _keep_logger(callbacks: object) -> None:
    """FMPy's proxy of loggers is one for the process: any FMU's next sentence goes to the logger it was given last."""
    _loggers.append(callbacks)
    _add_logger_proxy(callbacks)


fmpy.logging.addLoggerProxy = _keep_logger


def pytest_collection_finish() -> None:
    """What was imported and collected stays to the end: the garbage collector need not look at it again and again."""
    gc.collect()
    gc.freeze()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that take long come first, so that all workers end at about the same time."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)


@pytest.fixture
def nothing_trusted(monkeypatch, tmp_path_factory):
    """A cache of its own, in which no plugin and no file of a result is trusted yet."""
    from orchestrator.scene.plugins import trust

    monkeypatch.setenv("FANFOLD_CACHE", str(tmp_path_factory.mktemp("cache")))
    monkeypatch.setattr(trust, "_remembered", set())


@pytest.fixture
def kept_registry():
    """Leaves the kinds of components, the plugins and the figures that there were before."""
    from orchestrator.views import plots  # which most tests do without

    registers = REGISTRY, plugins._loaded, plots._added
    kept = [dict(known) for known in registers]
    yield
    for known, before in zip(registers, kept, strict=True):
        known.clear()
        known.update(before)
