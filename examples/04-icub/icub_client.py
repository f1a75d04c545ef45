"""A part of the iCub, from a test's side."""

from __future__ import annotations

from typing import Any

import yarp

WAIT_SECS = 5.0


class Part:
    """One part's ports: encoders in, set-points out, questions. All angles in degrees."""

    def __init__(self, test: Any, prefix: str) -> None:
        """Connect to the part; ports of our own are named after the plug-in."""
        self._test = test
        self._prefix = prefix
        own = f"/{test.name}{prefix}"
        self._state = yarp.BufferedPortVector()
        self._command = yarp.BufferedPortVector()
        self._rpc = yarp.RpcClient()
        ports = ((self._state, "state:i"), (self._command, "command:o"), (self._rpc, "rpc:o"))
        for port, name in ports:
            if not port.open(f"{own}/{name}"):
                raise ConnectionError(f"no port {own}/{name}: does YARP's name server run?")
        connected = (
            yarp.Network.connect(f"{prefix}/state:o", f"{own}/state:i")
            and yarp.Network.connect(f"{own}/command:o", f"{prefix}/command:i")
            and self._rpc.addOutput(f"{prefix}/rpc:i")
        )
        if not connected:
            raise ConnectionError(f"{prefix} cannot be reached")
        self.names = self._ask("get names")

    def degrees(self) -> list[float]:
        """The newest encoders; waits for the next ones."""
        newest: list[float] = []

        def arrived() -> bool:
            vector = self._state.read(False)
            if vector is not None:
                newest[:] = [vector[i] for i in range(vector.size())]
            return bool(newest)

        self._test.wait_until(arrived, WAIT_SECS, f"encoders of {self._prefix}")
        return newest

    def send(self, degrees: list[float]) -> None:
        """Tells the joints where to go."""
        vector = self._command.prepare()
        vector.resize(len(degrees))
        for i, value in enumerate(degrees):
            vector[i] = value
        self._command.writeStrict()

    def close(self) -> None:
        """Gives the ports back."""
        for port in (self._state, self._command, self._rpc):
            port.interrupt()
            port.close()

    def _ask(self, question: str) -> list[str]:
        asked, answer = yarp.Bottle(question), yarp.Bottle()
        if not self._rpc.write(asked, answer):
            raise ConnectionError(f"{self._prefix}/rpc:i does not answer")
        return [answer.get(i).toString() for i in range(answer.size())]
