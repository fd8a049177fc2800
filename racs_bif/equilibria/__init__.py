"""Equilibria: their branches, special points and normal forms."""
