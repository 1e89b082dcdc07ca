"""label_counts."""
