"""A simulated arm that answers each line with a joint angle."""
