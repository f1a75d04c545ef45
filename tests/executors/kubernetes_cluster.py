"""A Kubernetes cluster for tests: its own control plane on loopback, and two nodes of node.py."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path
from types import TracebackType
from typing import Any

from waiting import until

IMAGE = "robot-tests:1"
CLAIM = "results"
NAMESPACE = "sim"
"""The namespace of the tests, not the default one."""
NODES = {"n1": ["rtf/robot"], "n2": []}
"""The nodes, with their extended resources."""
CONTROLLERS = "job-controller,garbage-collector-controller,pod-garbage-collector-controller"
CONTROLLERS += ",persistentvolume-binder-controller,ttl-after-finished-controller"

HERE = Path(__file__).resolve().parent
ROLE = HERE.parent.parent / "packaging/container/role.yaml"


class Cluster:
    """A cluster, which runs while it is a context."""

    def __init__(self, programs: Path, directory: Path, rtf: Path) -> None:
        self.programs = programs
        self.dir = directory
        self.volume = directory / "volume"
        self.volume.mkdir()
        self.rtf = rtf
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        etcd, api = free_ports(2)
        self.etcd = f"http://127.0.0.1:{etcd}"
        self.api_port = api
        self.api = f"https://127.0.0.1:{api}"
        for user in ("admin", "submitter", "stranger"):
            self.kubeconfig(user).write_text(json.dumps(self.configuration(user)))

    def __enter__(self) -> Cluster:
        """Starts everything."""
        try:
            self.start_control_plane()
            self.create_objects()
            for node in NODES:
                self.start_node(node)
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, _: BaseException | None, __: TracebackType | None
    ) -> None:
        """Ends everything; after an error, prints the logs."""
        if kind:
            self.print_logs()
        self.stop()

    def print_logs(self) -> None:
        """Prints the ends of the logs."""
        for log in sorted(self.dir.glob("*.out")):
            tail = log.read_text(errors="replace").splitlines()[-8:]
            print(f"--- {log.name}", *tail, sep="\n", file=sys.stderr)

    def start_control_plane(self) -> None:
        """Starts the components, and waits until the API server answers."""
        key = self.dir / "key"
        generate = ["ssh-keygen", "-q", "-t", "rsa", "-m", "PEM", "-N", "", "-f", str(key)]
        subprocess.run(generate, check=True)
        users = "admin,admin,1,system:masters\nsubmitter,submitter,2\nstranger,stranger,3\n"
        (self.dir / "users.csv").write_text(users)
        self.start("etcd", str(self.dir / "etcd"), self.etcd)
        self.start(
            "kube-apiserver",
            f"--etcd-servers={self.etcd}",
            "--bind-address=127.0.0.1",
            f"--secure-port={self.api_port}",
            f"--cert-dir={self.dir}",
            f"--token-auth-file={self.dir / 'users.csv'}",
            "--authorization-mode=RBAC",
            "--service-account-issuer=https://rtf.invalid",
            f"--service-account-key-file={key}",
            f"--service-account-signing-key-file={key}",
            "--service-cluster-ip-range=127.255.0.0/24",
            "--disable-admission-plugins=ServiceAccount",
        )
        until("the API server answers", lambda: self.kubectl_succeeds("get", "--raw=/readyz"))
        config = f"--kubeconfig={self.kubeconfig('admin')}"
        self.start(
            "kube-controller-manager",
            config,
            "--leader-elect=false",
            "--secure-port=0",
            f"--controllers={CONTROLLERS}",
        )
        self.start("kube-scheduler", config, "--leader-elect=false", "--secure-port=0")

    def create_objects(self) -> None:
        """Creates what an administrator would: the namespace, the volume, and permissions."""
        until(
            "the namespace exists", lambda: self.kubectl_succeeds("create", "namespace", NAMESPACE)
        )
        nfs = {"server": "127.0.0.1", "path": str(self.volume)}
        size = {"storage": "1Gi"}
        common = {"accessModes": ["ReadWriteMany"], "storageClassName": ""}
        volume = {"capacity": size, "nfs": nfs, "claimRef": {"namespace": NAMESPACE, "name": CLAIM}}
        claim = {"resources": {"requests": size}, "volumeName": "results"}
        self.create("v1", "PersistentVolume", "results", {"spec": volume | common})
        self.create("v1", "PersistentVolumeClaim", CLAIM, {"spec": claim | common})
        self.kubectl("create", "--namespace", NAMESPACE, "--filename", str(ROLE))
        binding = ["create", "rolebinding", "submitter", "--role=rtf-submitter", "--user=submitter"]
        self.kubectl(*binding, "--namespace", NAMESPACE)

    def create(self, version: str, kind: str, name: str, content: dict[str, Any]) -> None:
        """Creates an object."""
        body = {"apiVersion": version, "kind": kind, "metadata": {"name": name}} | content
        command = [str(self.programs / "kubectl"), "create", "--namespace", NAMESPACE, "-f", "-"]
        text = json.dumps(body).encode()
        subprocess.run(command, input=text, check=True, env=self.environment("admin"))

    def start_node(self, name: str) -> None:
        """Starts a node, in a process namespace that ends with it."""
        logs = self.dir / name
        logs.mkdir(exist_ok=True)
        command = ["unshare", "--pid", "--fork", "--mount-proc", "--kill-child", "--"]
        command += [sys.executable, str(HERE / "node.py"), name, self.api, "admin", IMAGE]
        environment = os.environ | {"PATH": f"{self.rtf.parent}:{os.environ['PATH']}"}
        self.start_process(name, [*command, str(logs), *NODES[name]], environment)

    def kill_node(self, name: str) -> None:
        """Kills all processes of a node, as a power failure does, and removes it."""
        process = self.processes.pop(name)
        process.kill()
        process.wait()
        self.kubectl("delete", "node", name)

    def start(self, name: str, *arguments: str) -> None:
        """Starts a component."""
        self.start_process(name, [str(self.programs / name), *arguments], dict(os.environ))

    def start_process(self, name: str, command: list[str], environment: dict[str, str]) -> None:
        """Starts a process of the cluster."""
        with (self.dir / f"{name}.out").open("ab") as output:
            self.processes[name] = subprocess.Popen(
                command, cwd=self.dir, env=environment, stdout=output, stderr=output
            )

    def stop(self) -> None:
        """Ends all processes, the nodes first."""
        for name, process in reversed(self.processes.items()):
            process.send_signal(signal.SIGKILL if name in NODES else signal.SIGTERM)
        for process in self.processes.values():
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def environment(self, user: str) -> dict[str, str]:
        """The environment of a user of the cluster."""
        path = f"{self.programs}:{os.environ['PATH']}"
        return os.environ | {"KUBECONFIG": str(self.kubeconfig(user)), "PATH": path}

    def kubeconfig(self, user: str) -> Path:
        """The configuration of a user."""
        return self.dir / f"{user}.json"

    def configuration(self, user: str) -> dict[str, Any]:
        """What `kubectl` needs to know."""
        cluster = {"server": self.api, "insecure-skip-tls-verify": True}
        return {
            "apiVersion": "v1",
            "kind": "Config",
            "current-context": "test",
            "clusters": [{"name": "test", "cluster": cluster}],
            "users": [{"name": user, "user": {"token": user}}],
            "contexts": [{"name": "test", "context": {"cluster": "test", "user": user}}],
        }

    def kubectl(self, *arguments: str) -> str:
        """The output of `kubectl` of the administrator."""
        command = [str(self.programs / "kubectl"), *arguments]
        done = subprocess.run(
            command, env=self.environment("admin"), check=True, capture_output=True, text=True
        )
        return done.stdout

    def kubectl_succeeds(self, *arguments: str) -> bool:
        """Whether a command succeeds."""
        try:
            self.kubectl(*arguments)
        except subprocess.CalledProcessError:
            return False
        return True

    def objects(self, kind: str) -> list[dict[str, Any]]:
        """All objects of a kind in the namespace of the tests."""
        text = self.kubectl("get", kind, "--namespace", NAMESPACE, "--output=json")
        found: list[dict[str, Any]] = json.loads(text)["items"]
        return found

    def pods(self, phase: str) -> list[str]:
        """The pods in a phase."""
        pods = self.objects("pods")
        return [pod["metadata"]["name"] for pod in pods if pod["status"].get("phase") == phase]

    def uncordon(self) -> bool:
        """Permits pods on all nodes. Returns whether all nodes exist."""
        return self.kubectl_succeeds("uncordon", *NODES)

    def clean(self) -> None:
        """Removes ended jobs, and waits until nothing is left."""
        self.kubectl("delete", "jobs", "--all", "--namespace", NAMESPACE, "--cascade=foreground")
        until("no pod is left", lambda: not self.objects("pods"))
        for node in NODES.keys() - self.processes.keys():
            self.start_node(node)
        until("all nodes exist", self.uncordon)
        shutil.rmtree(self.volume)
        self.volume.mkdir()


def free_ports(count: int) -> list[int]:
    """Free ports of loopback."""
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports
