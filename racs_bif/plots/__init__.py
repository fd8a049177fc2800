"""Pictures, drawn from results only."""
