#!/usr/bin/env python3
"""A node of a Kubernetes cluster for tests: runs the pods that the scheduler has assigned to it.

    node.py NAME API TOKEN IMAGE DIRECTORY [RESOURCE…]

It does what a kubelet does, with processes of this machine instead of containers: each pod has its
own process and mount namespace, in which its first process has id 1, sees only the environment of
its manifest, and finds its volumes where the manifest mounts them. The root directory is that of
this machine; only IMAGE exists. Output is in DIRECTORY/POD.log. When the node is killed, so are all
of its processes: it must be the first process of a process namespace.
"""

from __future__ import annotations

import ctypes
import json
import os
import re
import signal
import ssl
import subprocess
import sys
import threading
import urllib.error
import urllib.request
from datetime import datetime, timezone
from http.client import HTTPResponse
from pathlib import Path
from typing import Any

# Binds pairs of directories, changes the directory, and executes the command of the container.
START = """
mount -t proc proc /proc
while [ "$1" != -- ]; do mkdir -p "$2"; mount --bind "$1" "$2"; shift 2; done
cd "$2" && shift 2 && exec "$@"
"""
INSECURE = ssl._create_unverified_context()
LAST_LOG_LINES = 80
LIBC = ctypes.CDLL(None, use_errno=True)
CLONE_NEWPID = 0x20000000

Object = dict[str, Any]


class Api:
    """The API server."""

    def __init__(self, url: str, token: str) -> None:
        self.url = url
        self.token = token

    def open(
        self, method: str, path: str, body: Object | None = None, kind: str = "application/json"
    ) -> HTTPResponse:
        """A response."""
        data = None if body is None else json.dumps(body).encode()
        headers = {"Authorization": f"Bearer {self.token}", "Content-Type": kind}
        request = urllib.request.Request(self.url + path, data, headers, method=method)
        response: HTTPResponse = urllib.request.urlopen(request, context=INSECURE)
        return response

    def call(
        self, method: str, path: str, body: Object | None = None, kind: str = "application/json"
    ) -> Object:
        """An object."""
        with self.open(method, path, body, kind) as response:
            found: Object = json.load(response)
            return found

    def patch(self, path: str, body: Object) -> None:
        """Changes an object. Does nothing if it does not exist."""
        try:
            self.call("PATCH", path, body, "application/merge-patch+json")
        except urllib.error.HTTPError as error:
            if error.code != 404:
                raise


class Pod:
    """A pod of this node."""

    def __init__(self, node: Node, pod: Object) -> None:
        self.node = node
        self.spec = pod["spec"]
        self.metadata = pod["metadata"]
        (self.container,) = self.spec["containers"]
        namespace, self.name = self.metadata["namespace"], self.metadata["name"]
        self.namespace = f"/api/v1/namespaces/{namespace}"
        self.path = f"{self.namespace}/pods/{self.name}"
        self.log = node.dir / f"{self.name}.log"
        self.process: subprocess.Popen[bytes] | None = None
        self.deleted = threading.Event()
        self.kill_timer: threading.Timer | None = None

    def run(self) -> None:
        """Runs the container, and reports how it has ended."""
        if self.container["image"] != self.node.image:
            message = f"no such image: {self.container['image']}"
            self.report("Pending", {"waiting": {"reason": "ErrImagePull", "message": message}})
            self.deleted.wait()
            self.report("Failed", None)
        else:
            started = now()
            self.process = self.start()
            self.report("Running", {"running": {"startedAt": started}})
            if self.deleted.is_set():
                self.terminate(self.spec["terminationGracePeriodSeconds"])
            code = self.process.wait()
            self.ended(started, code if code >= 0 else 128 - code)
        self.deleted.wait()
        body = {"gracePeriodSeconds": 0, "preconditions": {"uid": self.metadata["uid"]}}
        try:
            self.node.api.call("DELETE", self.path, body)
        except urllib.error.HTTPError as error:
            if error.code not in (404, 409):
                raise

    def start(self) -> subprocess.Popen[bytes]:
        """Starts the container."""
        command = ["unshare", "--mount", "--", "/bin/sh", "-e", "-c", START, "sh"]
        for mount in self.container.get("volumeMounts", []):
            command += [self.volume(mount["name"]), mount["mountPath"]]
        command += ["--", self.container.get("workingDir", "/")]
        environment = {"PATH": self.node.path, "HOME": "/root", "HOSTNAME": self.name}
        for variable in self.container.get("env", []):
            environment[variable["name"]] = self.value(variable)
        words = self.container["command"] + self.container.get("args", [])
        command += [expand(word, environment) for word in words]
        started: list[subprocess.Popen[bytes]] = []

        def start() -> None:
            # The next process of this thread is the first one of a namespace.
            if LIBC.unshare(CLONE_NEWPID) != 0:
                raise OSError(ctypes.get_errno(), "unshare")
            nothing = subprocess.DEVNULL
            with self.log.open("wb") as log:
                started.append(
                    subprocess.Popen(
                        command, env=environment, stdin=nothing, stdout=log, stderr=log
                    )
                )

        thread = threading.Thread(target=start)
        thread.start()
        thread.join()
        return started[0]

    def volume(self, name: str) -> str:
        """The directory of a volume."""
        (volume,) = (it for it in self.spec["volumes"] if it["name"] == name)
        claim = volume["persistentVolumeClaim"]["claimName"]
        claims = f"{self.namespace}/persistentvolumeclaims"
        name = self.node.api.call("GET", f"{claims}/{claim}")["spec"]["volumeName"]
        spec = self.node.api.call("GET", f"/api/v1/persistentvolumes/{name}")["spec"]
        path: str = spec["nfs"]["path"]
        return path

    def value(self, variable: Object) -> str:
        """The value of a variable."""
        if "value" in variable:
            return str(variable["value"])
        path = variable["valueFrom"]["fieldRef"]["fieldPath"]
        if match := re.fullmatch(r"metadata\.(annotations|labels)\['(.*)'\]", path):
            return str(self.metadata[match[1]][match[2]])
        return str({"spec.nodeName": self.spec["nodeName"], "metadata.name": self.name}[path])

    def ended(self, started: str, code: int) -> None:
        """Reports how the container has ended."""
        if self.kill_timer:
            self.kill_timer.cancel()
        state = {"exitCode": code, "reason": "Completed" if code == 0 else "Error"}
        lines = self.log.read_text(errors="replace").splitlines()[-LAST_LOG_LINES:]
        if code != 0 and self.container["terminationMessagePolicy"] == "FallbackToLogsOnError":
            state["message"] = "\n".join(lines)
        state |= {"startedAt": started, "finishedAt": now()}
        self.report("Succeeded" if code == 0 else "Failed", {"terminated": state})

    def report(self, phase: str, state: Object | None) -> None:
        """Reports the state of the pod and its container."""
        status: Object = {"phase": phase, "startTime": self.metadata["creationTimestamp"]}
        if state:
            container = {"name": self.container["name"], "image": self.container["image"]}
            is_ready = "running" in state
            container |= {"imageID": "", "restartCount": 0, "ready": is_ready, "state": state}
            status["containerStatuses"] = [container]
        self.node.api.patch(f"{self.path}/status", {"status": status})

    def delete(self, grace_secs: int) -> None:
        """The pod is deleted: its process gets SIGTERM, and later SIGKILL."""
        is_first = not self.deleted.is_set()
        self.deleted.set()
        if self.process and is_first:
            self.terminate(grace_secs)
        elif self.process:
            self.kill_after(grace_secs)

    def terminate(self, grace_secs: int) -> None:
        """Sends SIGTERM to the first process of the pod."""
        self.signal(signal.SIGTERM)
        self.kill_after(grace_secs)

    def kill_after(self, grace_secs: int) -> None:
        """Sends SIGKILL, unless the pod has ended by then."""
        if self.kill_timer:
            self.kill_timer.cancel()
        self.kill_timer = threading.Timer(grace_secs, self.signal, [signal.SIGKILL])
        self.kill_timer.daemon = True
        self.kill_timer.start()

    def signal(self, number: int) -> None:
        """Signals the first process of the pod."""
        assert self.process
        self.process.send_signal(number)


class Node:
    """The node."""

    def __init__(self, name: str, api: Api, image: str, directory: Path) -> None:
        self.name = name
        self.api = api
        self.image = image
        self.dir = directory
        self.path = os.environ["PATH"]
        self.pods: dict[str, Pod] = {}

    def register(self, resources: list[str]) -> None:
        """Adds the node to the cluster."""
        node = {"apiVersion": "v1", "kind": "Node", "metadata": {"name": self.name}}
        self.api.call("POST", "/api/v1/nodes", node)
        capacity = {"cpu": "2", "memory": "4Gi", "pods": "110"} | dict.fromkeys(resources, "1")
        ready = {"type": "Ready", "status": "True", "reason": "KubeletReady", "message": ""}
        status = {"capacity": capacity, "allocatable": capacity, "conditions": [ready]}
        self.api.patch(f"/api/v1/nodes/{self.name}/status", {"status": status})
        # The API server adds one, which the node controller would remove.
        self.api.patch(f"/api/v1/nodes/{self.name}", {"spec": {"taints": None}})

    def watch(self) -> None:
        """Handles the pods of this node."""
        pods = f"/api/v1/pods?fieldSelector=spec.nodeName={self.name}"
        version = self.api.call("GET", pods)["metadata"]["resourceVersion"]
        with self.api.open("GET", f"{pods}&watch=1&resourceVersion={version}") as events:
            for line in events:
                event = json.loads(line)
                if event["type"] in ("ADDED", "MODIFIED"):
                    self.on_pod(event["object"])

    def on_pod(self, pod: Object) -> None:
        """Starts a new pod, and stops one that is deleted."""
        metadata = pod["metadata"]
        known = self.pods.get(metadata["uid"])
        if known is None:
            known = self.pods[metadata["uid"]] = Pod(self, pod)
            threading.Thread(target=known.run, daemon=True).start()
        if "deletionTimestamp" in metadata:
            known.delete(metadata["deletionGracePeriodSeconds"])


def now() -> str:
    """The time, as Kubernetes writes it."""
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def expand(word: str, variables: dict[str, str]) -> str:
    """Replaces `$(NAME)` by a variable and `$$` by `$`, as Kubernetes does."""

    def replacement(match: re.Match[str]) -> str:
        return "$" if match[0] == "$$" else variables.get(match[1], match[0])

    return re.sub(r"\$\$|\$\(([^)]*)\)", replacement, word)


def main() -> None:
    """Runs the node."""
    name, url, token, image, directory, *resources = sys.argv[1:]
    node = Node(name, Api(url, token), image, Path(directory))
    node.register(resources)
    node.watch()


if __name__ == "__main__":
    main()
