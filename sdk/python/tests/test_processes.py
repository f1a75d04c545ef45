"""Processes that a plug-in starts from its own file."""

from __future__ import annotations

from pathlib import Path

import pytest
from driver import Host, arm, plugin, run

BODY = """
import multiprocessing
from concurrent.futures import ProcessPoolExecutor

class Joint:
    def __init__(self, angle):
        self.angle = angle

def double(joint):
    return Joint(2 * joint.angle)

def put(queue, joint):
    queue.put(double(joint))

if __name__ == "__main__":
    raise RuntimeError("a plug-in is not started as a program")

"""

RUN = """
context = multiprocessing.get_context(self.param)
queue = context.SimpleQueue()
process = context.Process(target=put, args=(queue, Joint(1)))
process.start()
process.join()
self.report(process.exitcode)
assert process.exitcode == 0 and queue.get().angle == 2
with context.Pool(2) as pool:
    doubled = pool.map(double, [Joint(2), Joint(3)])
assert [joint.angle for joint in doubled] == [4, 6]
with ProcessPoolExecutor(2, mp_context=context) as executor:
    assert executor.submit(double, Joint(4)).result().angle == 8
"""


@pytest.mark.parametrize("method", ["spawn", "forkserver", "fork"])
@pytest.mark.parametrize("name", ["plugin.py", "arm test.v2"])
def test_multiprocessing_finds_the_functions_of_the_plugin(
    tmp_path: Path, method: str, name: str
) -> None:
    host = Host(tmp_path)
    params = {**plugin(tmp_path, BODY + arm(RUN), name), "param": method}
    answer = host.ask("run-test", params)
    assert (host.problem(), answer["result"]) == (None, {"outcome": "passed"})
    assert host.texts()[0] == ("report", "0")
    assert host.end()[0] == 0


def test_an_exception_of_the_plugin_has_its_own_name(tmp_path: Path) -> None:
    ran = run(tmp_path, "class Stuck(Exception): pass\n" + arm("raise Stuck('in the door')"))
    assert ran.problem == ("error", "Stuck: in the door")
