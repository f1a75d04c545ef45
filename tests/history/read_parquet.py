"""Prints a Parquet file as JSON: metadata, number of rows, types of the columns, rows.

The interpreter has the packages of tools/requirements-export.txt.
"""

from __future__ import annotations

import json
import sys
from datetime import datetime

import pyarrow.parquet as pq

table = pq.read_table(sys.argv[1])
metadata = pq.read_metadata(sys.argv[1]).metadata
found = {
    "metadata": {key.decode(): value.decode("latin-1") for key, value in metadata.items()},
    "num_rows": table.num_rows,
    "columns": list(zip(table.column_names, map(str, table.schema.types), strict=True)),
    "rows": table.to_pylist(),
}
print(json.dumps(found, default=datetime.isoformat))
