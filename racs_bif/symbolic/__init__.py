"""Symbolic models and their compilation into fast, exact, vectorised code."""
