#!/usr/bin/env python3
"""Serves the world on TCP: `carry R R R` moves the arm, `reset …` begins the next episode.

python3 carry_simulator.py --port 17681
"""

from __future__ import annotations

import argparse
import os
import signal
import sys

import lesson_1  # noqa: F401 - makes `line_server` known
from line_server import LineServer, Refused
from world import Conditions, World


def answer(world: World, words: list[str]) -> str:
    """Carries out one line of a client."""
    try:
        match words:
            case ["carry", *targets] if len(targets) == len(world.joints):
                reached = world.carry([float(target) for target in targets])
                return " ".join(f"{value:.6f}" for value in reached)
            case ["reset", payload, friction, noise, seed]:
                numbers = float(payload), float(friction), float(noise)
                world.reset(Conditions(*numbers, int(seed)))
                return ""
    except ValueError as problem:
        raise Refused(str(problem)) from None
    raise Refused("expected `carry R R R` or `reset PAYLOAD FRICTION NOISE SEED`")


def main() -> int:
    """Serves until a signal asks for the end."""
    arguments = argparse.ArgumentParser(description="A robot arm that carries a payload.")
    arguments.add_argument("--port", type=int, required=True)
    port = arguments.parse_args().port
    asked_to_stop: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _frame: asked_to_stop.append(number))
    world = World(Conditions.of(dict(os.environ)))
    server = LineServer(port, lambda words: answer(world, words))
    print("the arm is ready", flush=True)
    while not asked_to_stop:
        server.serve(1.0)
    server.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
