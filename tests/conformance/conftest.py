"""Shared by all tests of FMUs."""

from __future__ import annotations

import os

import pytest


@pytest.fixture(autouse=True, scope="session")
def cache_of_tests(tmp_path_factory):
    """FMUs of the tests do not end up in the user's cache."""
    before = os.environ.get("FANFOLD_CACHE")
    os.environ["FANFOLD_CACHE"] = str(tmp_path_factory.mktemp("cache"))
    yield
    if before is None:
        del os.environ["FANFOLD_CACHE"]
    else:
        os.environ["FANFOLD_CACHE"] = before
