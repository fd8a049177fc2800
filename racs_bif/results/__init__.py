"""Results as data: branches, special points and diagrams, with their tables and their files."""
