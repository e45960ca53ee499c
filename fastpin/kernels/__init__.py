"""Compiled mathematics. Its functions take arrays and numbers, and return arrays or a code."""
