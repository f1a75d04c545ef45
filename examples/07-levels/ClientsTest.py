"""Stress: many clients talk to the arm at once."""

from __future__ import annotations

import argparse
import statistics
import time

import lesson_1  # noqa: F401 - makes arm_client known
import rtf
from arm_client import Arm

ROUNDS = 50


class ClientsTest(rtf.TestCase):
    """Opens many connections and asks all of them, round after round."""

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--clients", type=int, default=20)
        count = parser.parse_args(args).clients
        self.clients: list[Arm] = []
        for _ in range(count):
            self.clients.append(Arm())

    def run(self) -> None:
        latencies = []
        for _ in range(ROUNDS):
            for client in self.clients:
                asked = time.monotonic()
                client.position("elbow")
                latencies.append(time.monotonic() - asked)
        self.measure("median latency", 1e3 * statistics.median(latencies), "ms", high=20)
        self.measure("worst latency", 1e3 * max(latencies), "ms")

    def tearDown(self) -> None:
        for client in self.clients:
            client.close()
