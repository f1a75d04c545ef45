"""Two items for one function, with one node id, as launch_pytest has them."""

import pytest


def pytest_pycollect_makeitem(collector, name, obj):
    if not name.startswith("test_phases"):
        return None
    first, second = (pytest.Function.from_parent(collector, name=name) for _ in range(2))
    second.name = f"{second.name}[shutdown_test]"
    second.obj = lambda: obj(is_shutdown=True)
    first.obj = lambda: obj(is_shutdown=False)
    return [first, second]
