"""Is no Python."""

def generate_test_description(:  # line: syntax
    pass
