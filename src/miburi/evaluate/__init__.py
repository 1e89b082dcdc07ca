"""What was meant against what was found: queries, protocols, statistics, tables, metrics."""
