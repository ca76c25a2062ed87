"""Clients that come all at once: `python -m benchmarks.service_clients PORT CLIENTS EACH NAME`.

A process of its own, so that it takes nothing from the service but its cores. Each client queues
missions, asks for this and that, takes its missions back, and sees that they are; what it finds
is printed as JSON.
"""

import json
import sys
import threading
import time
from dataclasses import asdict, dataclass, field
from http.client import HTTPConnection

ROUND = 5
"""Requests of one round: queue, cell, ticks, take back, look."""


@dataclass(slots=True)
class Findings:
    """What the clients have seen."""

    requests: int = 0
    wrong: list[str] = field(default_factory=list)
    lost: int = 0
    times_ms: list[float] = field(default_factory=list)


class Client:
    """One of them."""

    def __init__(self, port: int, name: str, findings: Findings) -> None:
        """Connect."""
        self._connection = HTTPConnection("127.0.0.1", port, timeout=120)
        self._name, self._findings = name, findings

    def rounds(self, count: int) -> None:
        """Do so many rounds."""
        for number in range(count):
            body = json.dumps({"mission": "idle", "key": f"{self._name}/{number}"})
            queued = self._asked("POST", "/missions", 202, body)
            self._asked("GET", "/cell", 200)
            self._asked("GET", "/ticks?after=0&most=5", 200)
            place = f"/missions/{queued.get('id', 0)}"
            self._asked("DELETE", place, 200)
            if self._asked("GET", place, 200).get("state") != "withdrawn":
                self._findings.lost += 1

    def _asked(self, verb: str, path: str, code: int, body: str | None = None) -> dict[str, object]:
        began_s = time.perf_counter()
        headers = {"content-type": "application/json"} if body else {}
        self._findings.requests += 1
        try:
            self._connection.request(verb, path, body, headers)
            answer = self._connection.getresponse()
            text = answer.read()
        except OSError as error:
            self._connection.close()
            self._findings.wrong.append(f"{verb} {path}: {error!r}")
            return {}
        self._findings.times_ms.append(1e3 * (time.perf_counter() - began_s))
        if answer.status != code:
            self._findings.wrong.append(f"{verb} {path}: {answer.status} {text[:200]!r}")
        found = json.loads(text)
        return found if isinstance(found, dict) else {}


def flood(port: int, clients: int, each: int, name: str) -> Findings:
    """Let clients ask, so many requests each; return what they have found."""
    findings = Findings()
    threads = [
        threading.Thread(
            target=Client(port, f"{name}/{number}", findings).rounds, args=(each // ROUND,)
        )
        for number in range(clients)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return findings


def main() -> None:
    """Flood, and print what was found."""
    port, clients, each = (int(word) for word in sys.argv[1:4])
    found = flood(port, clients, each, sys.argv[4])
    print(json.dumps({**asdict(found), "wrong": found.wrong[:5], "wrongs": len(found.wrong)}))


if __name__ == "__main__":
    main()
