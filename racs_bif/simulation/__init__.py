"""Time histories of the exact fractional operator and of its realisation, and what they show."""
