"""The service against its own OpenAPI: Schemathesis makes up requests, sound and unsound ones."""

import re
import subprocess
import sys
from pathlib import Path

BIN = Path(sys.executable).parent
CELL = "format: 1\ncell: probed\nworld: dry\n"
MISSION = "format: 1\nmission: nap\ncell: probed\nroot: {wait: 0.1}\n"
# Allow of a 405 names the methods of one route, and a mission that is unknown is a 400.
CHECKS = (
    "not_a_server_error,status_code_conformance,content_type_conformance,"
    "response_headers_conformance,response_schema_conformance,negative_data_rejection"
)


def test_no_request_breaks_the_service(tmp_path):
    (tmp_path / "probed.yaml").write_text(CELL)
    (tmp_path / "nap.yaml").write_text(MISSION)
    serve = [BIN / "cellwright", "serve", "probed.yaml", "--port", "0"]
    with subprocess.Popen(serve, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as service:
        found = re.search(r"http://\S+/openapi\.json", service.stderr.readline())
        assert found
        words = [found[0], "--max-examples", "4", "--seed", "1", "--checks", CHECKS]
        answer = subprocess.run(
            [BIN / "schemathesis", "run", *words, "--phases", "coverage,fuzzing"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        service.terminate()
        service.communicate(timeout=60)
    assert answer.returncode == 0, answer.stdout[-4000:]
    assert service.returncode == 0
