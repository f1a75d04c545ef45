"""Vector environments: created, checked, given parameters, and closed."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from multiprocessing import connection
from signal import Signals
from typing import Any, Callable

import gymnasium
from gymnasium import vector

from rtf._stop import Error

Parameters = dict[int, dict[str, str]]
"""The parameters of episodes, by the slots from 0."""

_ATTRIBUTE = "parameters"

# A process that has closed its pipe ends soon.
_END_SECONDS = 5.0

# Of guarded environments.
_SETTER = "set_episode_parameters"


def make(
    make_env: Callable[[], gymnasium.Env[Any, Any]], slots: int, *, asynchronous: bool
) -> vector.VectorEnv[Any, Any, Any]:
    """Create a vector environment of `slots` environments, each of them guarded."""
    _require_version()
    # They need this version.
    from rtf.gymnasium.guarded_env import GuardedEnv  # noqa: PLC0415
    from rtf.gymnasium.guarded_vector_env import GuardedVectorEnv  # noqa: PLC0415

    def guarded(slot: int) -> GuardedEnv:
        env = make_env()
        if not isinstance(env, gymnasium.Env):
            raise Error(f"`make_env` returned {type(env).__name__}, expected a `gymnasium.Env`")
        return GuardedEnv(env, slot)

    functions = [partial(guarded, slot) for slot in range(slots)]
    mode = vector.AutoresetMode.DISABLED
    if asynchronous:
        # The policy and the test cannot always be pickled.
        return vector.AsyncVectorEnv(functions, context="fork", autoreset_mode=mode)
    return GuardedVectorEnv(functions, autoreset_mode=mode)


def _require_version() -> None:
    if not hasattr(vector, "AutoresetMode"):
        version = gymnasium.__version__
        raise Error(f"`rtf.gymnasium` needs Gymnasium 1.1 or later, found {version}")


def check(envs: Any, slots: int) -> None:
    """Raise an error if episodes cannot run in a vector environment."""
    _require_version()
    kind = type(envs).__name__
    if not isinstance(envs, vector.VectorEnv):
        raise Error(f"`make_envs` returned {kind}, expected a `gymnasium.vector.VectorEnv`")
    if envs.num_envs != slots:
        text = f"`{kind}` has {envs.num_envs} slots, expected {slots}, the argument of `make_envs`"
        raise Error(text)
    mode = envs.metadata.get("autoreset_mode")
    if mode not in {vector.AutoresetMode.DISABLED, vector.AutoresetMode.DISABLED.value}:
        name = "none" if mode is None else getattr(mode, "name", str(mode))
        raise Error(
            f"`{kind}` must not reset its slots by itself: a slot that starts whenever the last"
            " episode is over runs more of the short episodes. Its `autoreset_mode` is"
            f" {name}, expected `gymnasium.vector.AutoresetMode.DISABLED`"
        )


class SlotParameters:
    """The attribute `parameters` of the environments."""

    def __init__(self, envs: vector.VectorEnv[Any, Any, Any]) -> None:
        """Find out whether the environments have it, and whether they are guarded."""
        self._envs: Any = envs.unwrapped
        self.is_taken = self._have(_ATTRIBUTE)
        self._is_guarded = self._have(_SETTER)
        self._values: list[dict[str, str]] = [{} for _ in range(envs.num_envs)]
        self._changed: Parameters = {}

    def _have(self, name: str) -> bool:
        call = getattr(self._envs, "call", None)
        return call is not None and all(call("has_wrapper_attr", name))

    def set(self, slot: int, parameters: dict[str, str]) -> None:
        """Set those of a slot, if its environment takes them, in the next `apply`."""
        if self.is_taken:
            self._changed[slot] = self._values[slot] = dict(parameters)

    def apply(self) -> None:
        """Hand out what was set."""
        if self._changed and self._is_guarded:
            self._envs.call(_SETTER, self._changed)
        elif self._changed:
            self._envs.set_attr(_ATTRIBUTE, self._values)
        self._changed = {}


def close_after_problem(envs: Any) -> None:
    """Close a vector environment that may not answer any more."""
    processes = _processes(envs)
    # Not a second problem, after the one that is reported.
    with suppress(Exception):
        envs.close(**({"terminate": True} if processes else {}))
    for process in processes:
        process.terminate()
        process.join()


def ended_processes(envs: Any, problem: Exception) -> dict[int, str]:
    """Return how the processes of environments have ended, by the slots, if that is a problem."""
    processes = _processes(envs)
    if not processes or not isinstance(problem, (EOFError, OSError)):
        return {}
    ended = connection.wait([process.sentinel for process in processes], _END_SECONDS)
    for process in processes:
        # Its files are closed before its exit code is known.
        if process.sentinel in ended:
            process.join(_END_SECONDS)
    codes = {slot: process.exitcode for slot, process in enumerate(processes)}
    return {
        slot: f"exit code {code}" if code >= 0 else Signals(-code).name
        for slot, code in codes.items()
        if code is not None
    }


def _processes(envs: Any) -> list[Any]:
    base = getattr(envs, "unwrapped", None)
    return list(base.processes) if isinstance(base, vector.AsyncVectorEnv) else []
