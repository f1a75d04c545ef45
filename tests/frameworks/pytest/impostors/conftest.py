"""Disturbs pytest and the report."""

import os
import socket

import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop():
    """Runs no tests."""
    if os.environ.get("IMPOSTOR") == "idle":
        return True
    return None


def pytest_sessionfinish():
    """Ends before the report is complete."""
    if os.environ.get("IMPOSTOR") == "late exit":
        os._exit(0)


@pytest.fixture
def garbage():
    """Finds the connection of the reporter and sends a packet."""
    if os.environ.get("IMPOSTOR") != "garbage":
        return
    for number in range(3, 100):
        try:
            connection = socket.socket(fileno=os.dup(number))
        except OSError:
            continue
        if connection.type == socket.SOCK_SEQPACKET:
            connection.send(b"Hello, arm.")
            return
