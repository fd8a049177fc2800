"""Stability charts: boundaries traced in planes of two parameters, counts and maps over them."""
