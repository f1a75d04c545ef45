"""Prints the samples of the OpenMetrics on standard input as JSON: name, labels, value.

The interpreter has the packages of tools/requirements-telemetry.txt.
"""

from __future__ import annotations

import json
import sys

from prometheus_client.openmetrics.parser import text_string_to_metric_families as parse

samples = [sample for family in parse(sys.stdin.read()) for sample in family.samples]
print(json.dumps([[each.name, list(each.labels.values()), float(each.value)] for each in samples]))
