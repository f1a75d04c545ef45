"""Validates a manifest with the schemas of some versions of Kubernetes.

    validate_manifest.py FILE VERSION…

The interpreter has the packages of tools/requirements-kubernetes.txt.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import kubernetes_validate

text = Path(sys.argv[1]).read_text()
versions = sys.argv[2:]
for version in versions:
    kubernetes_validate.validate(json.loads(text), version, strict=True)
try:
    misspelt = json.loads(text.replace("podFailurePolicy", "podFailurePolicies"))
    kubernetes_validate.validate(misspelt, versions[-1], strict=True)
except kubernetes_validate.ValidationError:
    print("ok:", *versions)
else:
    sys.exit("a misspelt field is valid")
