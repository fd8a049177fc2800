"""Curves of special cycles in two parameters."""
