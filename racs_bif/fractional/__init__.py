"""Fractional-order elements: laws, rational realisations, and the exact operator."""
