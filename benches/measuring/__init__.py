"""How things are measured and judged; what is measured stands in `lines`."""
