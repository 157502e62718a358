"""Pictures that need not fit into memory: tiles over several processes, a journal, band after band (docs/large.md)."""
