"""Makes the work pool and serves every flow of prefect.yaml on the server that PREFECT_API_URL names.

python -m deploy.serve          # in the container `deployments`; `make up` does the same on one machine
"""

from __future__ import annotations

import subprocess
import sys

from deploy import services
from sgcad_core import settings

LIMIT_S = 300.0


def main() -> int:
    """Prefect's exit code; the pool may be there already."""
    for command in (services.pool_command(), services.deploy_command()):
        code = subprocess.run(command, cwd=settings.ROOT, timeout=LIMIT_S).returncode  # noqa: S603 - our own commands
    return code


if __name__ == "__main__":
    sys.exit(main())
